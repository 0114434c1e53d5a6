// Interface automata after de Alfaro & Henzinger (FSE 2001), without hidden actions, as in Aarts &
// Vaandrager (CONCUR 2010). The environment gives inputs (written ?a), the system emits outputs
// (written !a).
//
// An input may be impossible for one of three reasons. They stay apart all the way to a verdict:
//
//   refused     no transition: the actor is busy, or an output is due
//   unexplored  marked: it lies beyond the learning purpose's bound and was never tried
//   absorbed    a marked self-loop: never tried, but drawn
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"

namespace maide {

// An input or an output, as a symbol of the automaton's input or output alphabet.
struct Action {
  enum class Kind : std::uint8_t { input, output };
  Kind kind = Kind::input;
  Symbol symbol = 0;
  bool is_input() const { return kind == Kind::input; }
  auto operator<=>(const Action&) const = default;
};

class InterfaceAutomaton {
 public:
  struct Transition {
    Action action;
    StateId target = 0;
    bool absorbed = false;  // only on input self-loops: drawn, never tried
    auto operator<=>(const Transition&) const = default;
  };

  InterfaceAutomaton() = default;
  InterfaceAutomaton(Alphabet inputs, Alphabet outputs, std::size_t states);

  const Alphabet& inputs() const { return inputs_; }
  const Alphabet& outputs() const { return outputs_; }
  Symbol intern_output(std::string_view name) { return outputs_.intern(name); }
  // "?write" or "!message".
  std::string name(Action action) const;

  std::size_t size() const { return states_.size(); }
  std::size_t transition_count() const;  // absorbed self-loops included. O(size)
  StateId initial() const { return initial_; }
  void set_initial(StateId state) { initial_ = state; }
  StateId add_state();

  // Adds a transition; an equal one is not added twice. O(transitions of the state).
  void add_transition(StateId from, Action action, StateId to, bool absorbed = false);
  // Marks `input` as never tried in `state`. Idempotent.
  void mark_unexplored(StateId state, Symbol input);

  // Sorted: inputs before outputs, by symbol, by target.
  std::span<const Transition> transitions(StateId state) const {
    return states_[state].transitions;
  }
  // Inputs never tried here, ascending; absorbed ones are not repeated here.
  std::span<const Symbol> unexplored(StateId state) const { return states_[state].unexplored; }
  bool is_unexplored(StateId state, Symbol input) const;
  // The first successor by `action`, or Mealy::no_state. Absorbed transitions count.
  StateId successor(StateId state, Action action) const;

  // No output is enabled.
  bool is_quiescent(StateId state) const;
  // Every input is enabled (an absorbed or unexplored one is not).
  bool is_input_enabled(StateId state) const;
  bool is_input_enabled() const;
  // At most one successor for each state and action.
  bool is_deterministic() const;

  Origin origin;                            // where the model came from
  std::vector<Actor> actors;                // in their canonical order; empty: unknown
  std::vector<std::string> hidden_returns;  // inputs seen busy at quiescence whose return is not
                                            // observed

  bool operator==(const InterfaceAutomaton& other) const;  // same numbering, not only equivalent

 private:
  struct State {
    std::vector<Transition> transitions;
    std::vector<Symbol> unexplored;
    bool operator==(const State&) const = default;
  };
  Alphabet inputs_, outputs_;
  StateId initial_ = 0;
  std::vector<State> states_;
};

}  // namespace maide
