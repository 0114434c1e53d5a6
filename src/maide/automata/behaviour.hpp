// The behaviour of a model, in one form for models of all kinds: deterministic, minimal, and the
// same questions asked of two models. In each of its states a behaviour is asked each input, and of
// an interface automaton also what comes out by itself. Where a word may lead an automaton to
// several states, the set of them is one state (Rabin & Scott, "Finite automata and their decision
// problems", 1959).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

// The sets of states of one automaton that words lead to, each with a number. For a deterministic
// automaton all sets have one element.
class StateSets {
 public:
  using Id = std::uint32_t;
  using Set = std::vector<StateId>;  // sorted
  static constexpr Symbol no_symbol = ~Symbol{0};

  // Keeps the reference.
  explicit StateSets(const InterfaceAutomaton& automaton) : automaton_(automaton) {}

  Id intern(Set set);
  const Set& at(Id id) const { return sets_[id]; }
  // `no_symbol` is one that the automaton does not have.
  ActionStatus status(Id id, Action::Kind kind, Symbol symbol) const;
  // Whether no output may be due, and whether one may.
  std::pair<bool, bool> quiescence(Id id) const;
  // Behind an action that is enabled in some state of the set. Absorbed ways are not taken.
  Id successor(Id id, Action action);

 private:
  std::span<const InterfaceAutomaton::Transition> transitions(StateId state, Action action) const;

  const InterfaceAutomaton& automaton_;
  std::map<Set, Id> numbers_;
  std::vector<Set> sets_;
};

// ---- Behaviours ----

// How many steps of a comparison pass between two looks at its RunControl.
inline constexpr std::size_t comparison_check = 4096;

struct Answer {
  struct Way {
    Symbol label = 0;  // of BehaviourPair::labels
    StateId target = 0;
    bool operator==(const Way&) const = default;
  };
  Symbol text = 0;       // of BehaviourPair::texts: "message", "refused", "never tried", ...
  bool is_known = true;  // false: never tried, or in one of several states never tried
  std::vector<Way> ways;
};

// Only reachable states, in breadth-first order, no two equivalent.
struct Behaviour {
  StateId initial = 0;
  std::size_t size = 0;
  std::vector<Answer> answers;   // by state and question, state-major
  std::vector<StateId> origins;  // by state: a state of the model that it stands for
};

// The label with which an automaton says that nothing comes out; the first one of all.
inline constexpr const char* rest_label = "nothing";

// Two behaviours over the same questions and names.
struct BehaviourPair {
  // "write" of a machine; "?write", and last what comes out by itself, of an automaton.
  std::vector<std::string> questions;
  std::vector<bool> is_common;  // by question: whether both models know it
  bool has_outputs = false;     // whether the last question is what comes out by itself
  Alphabet labels;              // of ways: "write / message", "?write", "!message"
  Alphabet texts;               // of answers
  Behaviour left, right;
  std::vector<StateId> equivalent;  // by left's state: the same of right's, or Mealy::no_state

  const Answer& left_answer(StateId state, std::size_t question) const {
    return left.answers[std::size_t{state} * questions.size() + question];
  }
  const Answer& right_answer(StateId state, std::size_t question) const {
    return right.answers[std::size_t{state} * questions.size() + question];
  }
  // Whether a way is the one on which nothing comes out and nothing changes.
  bool is_rest(Symbol label) const { return has_outputs && label == 0; }
};

// Machines must be complete. Signatures (automata/partition.hpp) make equivalent states one: at
// worst n rounds of n k. Throws Interrupted.
BehaviourPair read_behaviours(const NondeterministicMealy& left, const NondeterministicMealy& right,
                              const RunControl& control = {});
BehaviourPair read_behaviours(const InterfaceAutomaton& left, const InterfaceAutomaton& right,
                              const RunControl& control = {});

}  // namespace maide
