// Random machines for tests and benchmarks: uniform ones, changed copies of a machine, interface
// automata, and machines that hide something. The same seed gives the same machine everywhere.
// Every state is reachable, but for changed copies. Two states may be equivalent, but for machines
// that hide something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

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

// A mutant of the machine, as a stand-in for its next version. Makes `changes` changes. A change
// gives a transition another output, gives it another target, or leads it to a new state: a copy of
// its target with one transition changed. Outputs are among those that the machine has. A change
// may by chance change nothing, and states may become unreachable. Throws UsageError for a machine
// without transitions. O(states x inputs).
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

// ---- Machines that hide something ----
//
// Most inputs do nothing; a few rare ones in a row, or one often enough, lead on. Uniform random
// machines hide nothing, so tests that miss most of a real protocol pass on them. No two states are
// equivalent.
enum class Hiding : std::uint8_t {
  pairs,     // levels, each left by two rare inputs in a row; a third shows where one is
  triples,   // the same by three in a row
  counters,  // one input so many times in a row, then another shows it; a second count may follow
  login,     // a password of three words, behind it a random machine
  sinks,     // a long way on which every wrong step ends in one of a few sinks for ever
  modes,     // one input turns through modes that answer alike but for a rare input each
  layers,    // random machines, each left from one state only, by one rare input
  nothing,   // a uniform random machine
};

std::span<const std::string_view> hiding_names();  // in the order above
// Throws UsageError that lists the known ones.
Hiding find_hiding(std::string_view name);

// A machine that hides something so, minimal, of about `states` states (at least 4, for counters
// at most 64) and `inputs` inputs (at least 4). Throws UsageError for less. O(states x inputs).
Mealy hiding_mealy(Hiding hiding, std::size_t states, std::size_t inputs, Random& random);

}  // namespace maide
