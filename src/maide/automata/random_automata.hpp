// Random machines for tests and benchmarks: the same seed gives the same machine everywhere. Every
// state is reachable; nothing else is promised (two states may be equivalent).
#pragma once

#include <cstddef>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"

namespace maide {

struct RandomMealyOptions {
  std::size_t states = 10;
  std::size_t inputs = 3;   // named i0, i1, ...
  std::size_t outputs = 3;  // named o0, o1, ...; not all need appear on transitions
};

// Targets and outputs are uniform but for a random tree that makes every state reachable. Throws
// UsageError unless there is at least one state and output, and an input where there are several
// states. O(states x inputs).
Mealy random_mealy(const RandomMealyOptions& options, Random& random);

// The machine of another version: so many times, one of: a transition gets another output, a
// transition gets another target, or a transition leads to a new state, a copy of its target with
// one transition changed. Outputs are among those the machine has; a change may by chance change
// nothing, and states may become unreachable. Throws UsageError for a machine without transitions.
// O(states x inputs).
Mealy mutate(const Mealy& machine, std::size_t changes, Random& random);

struct RandomInterfaceAutomatonOptions {
  std::size_t states = 10;
  std::size_t inputs = 3;     // named i0, i1, ...
  std::size_t outputs = 3;    // named o0, o1, ...
  double density = 0.4;       // probability that an action is enabled in a state
  double unexplored = 0.1;    // probability that an input that is not enabled is marked unexplored
  double absorbed = 0.05;     // probability that such an input is an absorbed self-loop instead
  bool deterministic = true;  // else some actions have several targets
};

// Throws UsageError unless there is at least one state and action. O(states x actions).
InterfaceAutomaton random_interface_automaton(const RandomInterfaceAutomatonOptions& options,
                                              Random& random);

}  // namespace maide
