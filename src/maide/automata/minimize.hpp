// Minimisation. Results keep only reachable states, numbered in breadth-first order from the
// initial state 0.
//
// Mealy machines: Hopcroft's partition refinement ("An n log n algorithm for minimizing states in a
// finite automaton", 1971), started from the partition by output rows. Interface automata: the
// coarsest bisimulation that also respects what was never tried (Kanellakis & Smolka, PODC 1983, by
// signatures). For a deterministic automaton that is the minimal one.
#pragma once

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"

namespace maide {

// `machine` must be complete. O(n k log n) time for n states and k inputs, O(n k) memory.
Mealy minimize(const Mealy& machine);

// Marks, actors, hidden returns and origin are kept. O(n m log m) worst case for m transitions.
InterfaceAutomaton minimize(const InterfaceAutomaton& automaton);

// The machine without unreachable states, numbered in breadth-first order. O(n k).
Mealy breadth_first(const Mealy& machine);

}  // namespace maide
