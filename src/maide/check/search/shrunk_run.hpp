// Leaves out of a run what its violation does not need. A search that is not breadth-first shows
// the first run that it comes by, in which programs do much that has nothing to do with the matter.
//
// First, what goes without a look at the property: the way round from a state back to it, before
// the loop; and steps before the loop that are its last ones, which are the loop's own. Then parts
// are left out on trial: all steps of a program, then pieces, from half the run down to one step
// (Zeller & Hildebrandt, "Simplifying and isolating failure-inducing input", IEEE Trans. Softw.
// Eng. 2002). Of what is left those steps are taken that are still possible, in their order, and
// models may be elsewhere than they were. A loop may come to be one that does not close at once
// (closed()).
//
// Where messages are on their way, the run in which each arrives as soon as it can is shrunk, too:
// it is taken if it is no longer, so what is late in it is so for a reason.
//
// Invariant: what is returned is a counterexample (find_flaw), with at most as many steps. It
// depends on the run and on nothing else: how much is tried is counted in steps.
#pragma once

#include <cstdint>

#include "maide/base/run_control.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

// `trace` is a counterexample for the property. After `most_steps` steps that were tried (one of a
// loop counts for each program, which may be able to step there), or when the control says to stop,
// the shortest so far.
Trace shrink(const System& system, const Property& property, Trace trace, const RunControl& control,
             std::uint64_t most_steps = std::uint64_t{1} << 17);

}  // namespace maide
