// From quiescence to quiescence: what a step of a translated machine does, and the interface
// automaton that such steps make. A step with outputs goes through one state for each pair (outputs
// still due, next state), shared. Used for deterministic and nondeterministic machines alike.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// What a machine of a translation does at a quiescent state on an input.
struct MacroStep {
  StepStatus status = StepStatus::taken;
  std::vector<std::string> outputs;  // in canonical order
  StateId target = 0;
};

// The step that an answer of the eager translation says: "quiet", "refused", "a,b", ...
MacroStep read_eager_step(const std::string& output, StateId target);

// Builds the interface automaton: quiescent states first, states with outputs due as they are met.
class IaExpander {
 public:
  // `states` quiescent states. Outputs of one actor keep their order; those of different actors may
  // be taken in any order.
  IaExpander(const Alphabet& inputs, std::size_t states, std::span<const Actor> actors);

  // What the input does in a quiescent state. A state may be given several steps for one input.
  void add_step(StateId state, Symbol input, const MacroStep& step);

  InterfaceAutomaton take() { return std::move(automaton_); }

 private:
  using Due = std::vector<std::vector<Symbol>>;  // for each actor that owes some: what, in order
  struct Unfinished {
    Due due;
    StateId target, source;
  };

  Due by_actor(const std::vector<std::string>& outputs);
  StateId due_state(const Due& due, StateId target);
  void take_each_first(const Due& due, StateId target, StateId source);

  InterfaceAutomaton automaton_;
  std::map<std::string, std::size_t> actor_of_;  // 0: of no actor
  std::map<std::pair<Due, StateId>, StateId> due_states_;
  std::vector<Unfinished> unfinished_;
};

}  // namespace maide
