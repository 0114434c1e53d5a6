// Where a run breaks a formula, in words: "planner@sent holds after step 7, but controller@done
// never holds from then on". The idea: walk down the formula along the reasons for its value, to
// the first position that a temporal operator was broken at, until something is left that a person
// sees in the trace.
#pragma once

#include <string>
#include <vector>

#include "maide/check/system.hpp"
#include "maide/check/trace.hpp"

namespace maide {

// A clause without a full stop. `trace` violates `formula`; `states` are replay()'s.
std::string describe_violation(const System& system, const Formula& formula, const Trace& trace,
                               const std::vector<GlobalState>& states);

}  // namespace maide
