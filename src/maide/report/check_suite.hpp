// The report of a check for continuous integration: a case a property. A violated one failed, with
// the sentence that explains it and its run; an inconclusive one is an error, with the reason.
#pragma once

#include "maide/check/system/system.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/report/junit.hpp"

namespace maide {

// The suite is named after the system file. What the verdicts rest on stands among its properties.
// O(steps of the runs x programs).
JUnitSuite make_check_suite(const System& system, const CheckReport& report);

}  // namespace maide
