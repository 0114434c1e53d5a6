// Machines that are given by what a step does, as the rules of a middleware are written by hand.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/automata/minimize.hpp"

namespace maide::test {

// The reachable part of the machine in which `step` leads from a state, by an input,
// to an output and the next state. Minimal.
template <typename State, typename StepFunction>
Mealy make_machine(const std::vector<std::string>& inputs, const State& initial,
                   const StepFunction& step) {
  Mealy machine(Alphabet(inputs), {}, 1);
  std::map<State, StateId> numbers{{initial, 0}};
  std::vector<State> states{initial};
  for (StateId from = 0; from < states.size(); ++from) {
    for (Symbol input = 0; input < inputs.size(); ++input) {
      const std::pair<std::string, State> next = step(State(states[from]), inputs[input]);
      const auto [entry, is_new] = numbers.try_emplace(next.second, machine.size());
      if (is_new) {
        machine.add_state();
        states.push_back(next.second);
      }
      machine.set_transition(from, input, machine.intern_output(next.first), entry->second);
    }
  }
  return minimize(machine);
}

}  // namespace maide::test
