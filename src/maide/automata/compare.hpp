// Compares two models and finds the shortest word that tells them apart; of several, the least in
// the order of the alphabet. Mealy machines: Hopcroft & Karp ("A linear algorithm for testing
// equivalence of finite automata", 1971). Interface automata: the pairs of sets of states that the
// same words reach are explored.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

// Whether an output says that nobody tried the input there: "unexplored" or "absorbed".
bool is_never_tried(std::string_view output);

// The deterministic automaton with the same traces, where those of these inputs that nobody sees
// are left out (subset construction). Refusals and what was never tried are lost. Throws UsageError
// beyond a million states, which may be exponential in the automaton's.
InterfaceAutomaton automaton_of_traces(const InterfaceAutomaton& automaton,
                                       std::span<const Symbol> silent, const RunControl& control);

struct MealyDifference {
  std::vector<std::string> word;  // inputs by name, never empty
  // What the machines answer to the word's last input; nothing: it is no input of this machine.
  std::optional<std::string> left, right;
};

// Nothing if the machines are equivalent: the same inputs by name, in whatever order, and the same
// outputs to every word. Of all shortest words that tell them apart the least one in the order of
// left's inputs (those that only right has come last). Both must be complete. O(k (n + m)) up to an
// inverse Ackermann factor, for k inputs and n, m states.
std::optional<MealyDifference> find_difference(const Mealy& left, const Mealy& right);

// The same word over left's alphabet. Throws UsageError if the inputs differ.
std::optional<Word> find_distinguishing_word(const Mealy& left, const Mealy& right);

// What an automaton does with an action after a word. Of several states that the word may have led
// to, some may do one thing and some another.
struct ActionStatus {
  bool enabled = false;  // may be taken or emitted
  bool refused = false;  // may be not enabled, though it was tried
  bool untried = false;  // may be unexplored or absorbed
  bool is_known = true;  // false: no action of this automaton's alphabet (refused is then true)
  bool operator==(const ActionStatus&) const = default;
};
// "enabled", "refused", "never tried", "not in the alphabet"; mixtures are joined by " or ".
std::string to_string(const ActionStatus& status);

// The models contradict each other: after the same actions one does what the other does not.
struct HardDifference {
  std::vector<std::string> word;  // "?input" and "!output"; the last one tells them apart
  ActionStatus left, right;       // of the last action
  std::vector<std::string> left_offers, right_offers;  // all that is enabled before the last action
};

// One knows what the other never tried.
struct SoftDifference {
  struct Input {
    std::string name;
    ActionStatus left, right;
  };
  std::vector<std::string> word;  // the shortest that leads there
  std::vector<Input> inputs;      // in alphabet order
};

struct IaComparison {
  std::optional<HardDifference> hard;
  std::vector<SoftDifference> soft;  // one for each pair of (sets of) states, shortest words first
  std::vector<std::string> notes;    // one line each; they do not make a difference by themselves

  bool same() const { return !hard && soft.empty(); }
  bool differ_in_marks_alone() const { return !hard && !soft.empty(); }
};

// Compares two automata after every word that both have: the actions they enable and refuse, and
// whether they may be quiescent there. A difference in quiescence alone has the last "action"
// "(quiescence)". Actions are matched by name. An input that only one automaton has is refused by
// the other. Absorbed inputs count as unexplored and are not followed. The word is a shortest one,
// and of those the alphabet-least: inputs first, in left's order. Cost: at most n m pairs for
// deterministic automata, exponentially many otherwise. Throws Interrupted.
IaComparison compare(const InterfaceAutomaton& left, const InterfaceAutomaton& right,
                     const RunControl& control = {});

}  // namespace maide
