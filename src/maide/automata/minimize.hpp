// Minimisation. Results keep only reachable states, numbered in breadth-first order from the
// initial state 0.
//
// Mealy machines: partition refinement, level by level (Moore, "Gedanken-experiments on sequential
// machines", 1956). A level splits by the parts of the blocks that the level before split. It looks
// only at their predecessors, and skips the largest part (Hopcroft, "An n log n algorithm for
// minimizing states in a finite automaton", 1971).
//
// Interface automata: the coarsest bisimulation that also respects what was never tried (Kanellakis
// & Smolka, PODC 1983, by signatures). For a deterministic automaton that is the minimal one.
#pragma once

#include <functional>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/partition.hpp"

namespace maide {

// Called after `fresh` was split off from `block`. Steps count levels and inputs. With k inputs,
// step l k + i splits states whose shortest separating word has l + 1 inputs. Of all such words, i
// is the least first input.
using SplitObserver =
    std::function<void(Partition::Block block, Partition::Block fresh, std::size_t step)>;

// The classes of states that no word tells apart. `machine` must be complete. O(n k log n) time for
// n states and k inputs, O(n k) memory.
Partition compute_state_classes(const Mealy& machine, const SplitObserver& on_split = {});

// `machine` must be complete. O(n k log n) time for n states and k inputs, O(n k) memory.
Mealy minimize(const Mealy& machine);

// Marks, actors, hidden returns and origin are kept. O(n m log m) worst case for m transitions.
InterfaceAutomaton minimize(const InterfaceAutomaton& automaton);

// The machine without unreachable states, numbered in breadth-first order. O(n k).
Mealy breadth_first(const Mealy& machine);

}  // namespace maide
