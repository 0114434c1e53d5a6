// Models in the input language of NuSMV 2 and nuXmv: one MODULE main whose transition relation is
// total. A Mealy machine has an input variable and an output that is defined from state and input;
// an interface automaton has an input variable `action`, one action a step (in_NAME, out_NAME), and
// `idle` in quiescent states.
#pragma once

#include <iosfwd>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// DEFINEs say where each input is possible (can_NAME) and where it was never tried
// (unexplored_NAME; absorbed self-loops are such). Throws UsageError for a Mealy machine without
// inputs. O(size).
void write_smv(std::ostream& out, const Model& model);

}  // namespace maide
