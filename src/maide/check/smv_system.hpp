// A whole system for NuSMV and nuXmv: a module for each model and each program, and one input
// variable of main, `step`, that says which of them move together. One transition is one step; the
// states are those of the system before any cut. Where nothing can happen, `step` is `idle` and the
// last state repeats, because SMV wants total relations; a step beyond what was learned
// (`beyond_...`) changes nothing. `INVARSPEC !deadlock` is the system's `deadlock`; programs define
// `ended` and `at_LABEL` for properties of one's own.
#pragma once

#include <iosfwd>

#include "maide/check/system.hpp"

namespace maide {

void write_smv(std::ostream& out, const System& system);

}  // namespace maide
