// From declarations and models to the system that is checked: programs are unrolled, shared
// variables become models, formulas get their atoms.
#pragma once

#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/models.hpp"

namespace maide {

// The search for the states of large queues gives up when the control's time is up; its stop token
// interrupts it (throws Interrupted). Throws ParseError: names and kinds that do not fit the
// models. O(control states).
System build_system(const Declarations& file, Models models, const QueueLimits& limits = {},
                    const RunControl& control = {});

// ---- Its parts ----

// One line each: what looks like an oversight.
void add_remarks(System& system, const std::vector<VariableName>& unused);

}  // namespace maide
