// A small explicit-state checker straight from the meaning of systems, for comparison with engines:
// breadth-first search for deadlocks and cuts, strongly connected components for a handful of
// temporal patterns. Slow and simple.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "maide/check/language/system.hpp"

namespace maide::test {

// The reachable graph. A node is a state with the step that led there (events are part of it); a
// finished or deadlocked state goes on to itself without an event.
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

  // A truth value for each node.
  using Label = std::vector<bool>;
  Label label(const Formula& boolean_expression) const;

  bool holds_globally(const Label& p) const;
  // p U q; `F q` with p true everywhere. `fair`: weakly fair runs only.
  bool holds_until(const Label& p, const Label& q, bool fair) const;
  bool holds_infinitely_often(const Label& p, bool fair) const;          // G F p
  bool holds_from_some_point(const Label& p, bool fair) const;           // F G p
  bool holds_response(const Label& p, const Label& q, bool fair) const;  // G (p -> F q)

 private:
  struct Edge {
    std::uint32_t target = 0;
    std::uint32_t program = 0;
  };
  struct Node {
    GlobalState state;
    std::optional<Step> last;
    std::vector<Edge> edges;
    std::vector<bool> enabled;  // by program
  };
  // Nodes within `allowed` from which an endless (fair) run stays within it and, if `visit` is
  // given, meets a node of it again and again.
  Label trap(const Label& allowed, bool fair, const Label* visit = nullptr) const;
  // Nodes reachable from `from` through nodes of `allowed`.
  Label reach(const Label& from, const Label& allowed) const;
  Label initial_only() const;

  const System& system_;
  bool is_complete_ = true;
  std::vector<Node> nodes_;
  std::map<std::vector<std::uint32_t>, std::size_t> state_depths_;
  std::optional<std::size_t> shortest_deadlock_, shortest_cut_;
};

}  // namespace maide::test
