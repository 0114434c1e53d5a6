// Observable nondeterministic Mealy machines: in each state an input may be answered in several
// ways, or in none (the machine is partial), and each answer leads to one next state. So a trace,
// inputs with outputs, leads to one state; a word of inputs alone may lead to several. (ONFSM:
// Starke, "Abstract automata", 1972; El-Fakih, Groz, Irfan, Shahbaz, "Learning finite state models
// of observable nondeterministic systems in a testing context", ICTSS 2010.)
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"

namespace maide {

class NondeterministicMealy {
 public:
  // One of the ways in which an input may be answered.
  struct Choice {
    Symbol output = 0;
    StateId target = 0;
    auto operator<=>(const Choice&) const = default;
  };

  NondeterministicMealy() = default;
  // `states` states numbered from 0, state 0 initial, no choices yet.
  NondeterministicMealy(Alphabet inputs, Alphabet outputs, std::size_t states);
  explicit NondeterministicMealy(const Mealy& machine);

  const Alphabet& inputs() const { return inputs_; }
  const Alphabet& outputs() const { return outputs_; }
  Symbol intern_output(std::string_view name) { return outputs_.intern(name); }

  std::size_t size() const { return states_; }
  std::size_t transition_count() const;  // O(size x inputs)
  StateId initial() const { return initial_; }
  void set_initial(StateId state) { initial_ = state; }

  // Adds a choice; the same one again is none. Throws UsageError if the output leads elsewhere
  // already: that would not be observable.
  void add_choice(StateId from, Symbol input, Symbol output, StateId to);
  // By ascending output.
  std::span<const Choice> choices(StateId from, Symbol input) const {
    return cells_[index(from, input)];
  }
  // The state behind an output, or Mealy::no_state. O(log choices).
  StateId successor(StateId from, Symbol input, Symbol output) const;

  // Some input has an answer there. O(inputs).
  bool answers_at(StateId state) const;
  // Every input has at least one answer in every state. O(size x inputs).
  bool is_complete() const;
  // No input has two answers in a state. O(size x inputs).
  bool is_deterministic() const;
  // The same machine as a deterministic one; nothing if it is not, or not complete.
  std::optional<Mealy> to_mealy() const;
  // Answers what has no answer with this output, and stays where it is. O(size x inputs).
  void complete_with(std::string_view output);

  Origin origin;              // where the model came from
  std::vector<Actor> actors;  // empty where the system has none

 private:
  std::size_t index(StateId from, Symbol input) const {
    return std::size_t{from} * inputs_.size() + input;
  }
  Alphabet inputs_, outputs_;
  std::size_t states_ = 0;
  StateId initial_ = 0;
  std::vector<std::vector<Choice>> cells_;  // state-major
};

// The minimal machine, unique up to numbering because the machine is observable: states are
// numbered in breadth-first order, inputs and then outputs (by name) ascending. Partition
// refinement by signatures, O(n^2 k) signatures at worst.
NondeterministicMealy minimize(const NondeterministicMealy& machine);

// A shortest trace that both machines have, and an input behind it that they answer in different
// sets of ways.
struct TraceDifference {
  std::vector<std::pair<std::string, std::string>> trace;  // inputs with outputs
  std::string input;
  std::vector<std::string> left, right;  // all outputs possible, sorted; none: no answer there
};

// Nothing if both have the same traces. Inputs and outputs are matched by name; of all shortest
// traces the first in the order of left's inputs. O(n m k choices) at worst.
std::optional<TraceDifference> find_difference(const NondeterministicMealy& left,
                                               const NondeterministicMealy& right);

}  // namespace maide
