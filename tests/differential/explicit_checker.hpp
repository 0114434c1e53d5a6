// A small explicit-state checker straight from the meaning of systems, for comparison with engines:
// breadth-first search for deadlocks and cuts, strongly connected components for a handful of
// temporal patterns. Slow and simple.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide::test {

// Whether some program, that has not ended and may not rest, never steps again on a run that is
// strongly fair to programs and to fair groups. At most a few hundred states.
bool has_stuck_program(const System& system);
// Steps to a nearest state in which some program can be so, and cannot step any more.
std::optional<std::size_t> nearest_stuck(const System& system);

// The reachable graph, but for errors. A node is a state with the step that led there (events are
// part of it); a finished or deadlocked state goes on to itself without an event.
class ExplicitChecker {
 public:
  // What becomes of the last event once nothing can happen any more: it is forgotten. To keep it is
  // wrong; that shows which comparisons depend on it.
  enum class LastEvent : std::uint8_t { forgotten, kept };
  // Gives up - is_complete() is then false - beyond `limit` nodes.
  ExplicitChecker(const System& system, std::size_t limit,
                  LastEvent last_event = LastEvent::forgotten);

  bool is_complete() const { return is_complete_; }
  std::size_t states() const { return state_depths_.size(); }  // before any cut
  std::optional<std::size_t> shortest_deadlock() const { return shortest_deadlock_; }
  std::optional<std::size_t> shortest_cut() const { return shortest_cut_; }
  std::optional<std::size_t> shortest_error() const { return shortest_error_; }

  // A truth value for each node.
  using Label = std::vector<bool>;
  Label label(const Formula& boolean_expression) const;

  bool holds_globally(const Label& p) const;
  // p U q; `F q` with p true everywhere. On the runs that are so fair, to programs and fair groups.
  bool holds_until(const Label& p, const Label& q, Fairness fairness) const;
  bool holds_infinitely_often(const Label& p, Fairness fairness) const;          // G F p
  bool holds_from_some_point(const Label& p, Fairness fairness) const;           // F G p
  bool holds_response(const Label& p, const Label& q, Fairness fairness) const;  // G (p -> F q)

 private:
  // A program (group 0), or a fair group, of a program or of nobody, whose number is the next
  // behind the programs'.
  using Who = std::pair<std::uint32_t, std::uint32_t>;
  struct Edge {
    std::uint32_t target = 0;
    std::uint32_t program = 0;
    std::uint32_t group = 0;
  };
  struct Node {
    GlobalState state;
    std::optional<Step> last;
    std::vector<Edge> edges;
    std::vector<bool> enabled;  // by program
    std::vector<Who> able;      // those that can step here
  };
  // Nodes within `allowed` from which an endless (fair) run stays within it and, if `visit` is
  // given, meets a node of it again and again.
  Label trap(const Label& allowed, Fairness fairness, const Label* visit = nullptr) const;
  bool is_asked_strongly(const Who& who, Fairness fairness) const;
  // Nodes reachable from `from` through nodes of `allowed`.
  Label reach(const Label& from, const Label& allowed) const;
  Label initial_only() const;

  const System& system_;
  bool is_complete_ = true;
  std::vector<Node> nodes_;
  std::map<std::vector<std::uint32_t>, std::size_t> state_depths_;
  std::optional<std::size_t> shortest_deadlock_, shortest_cut_, shortest_error_;
};

}  // namespace maide::test
