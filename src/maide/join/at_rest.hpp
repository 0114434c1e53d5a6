// Runs of a system with messages on their way, as runs on real connections that come to rest
// between any two steps. Nobody can hold a message back there, so a run that needs a late one
// cannot be played. What is played is a run of the system at rest (Deliveries).
#pragma once

#include <optional>
#include <string>

#include "maide/base/run_control.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

struct RestingRun {
  Trace trace;
  bool is_another = false;  // its programs do something else than in the run that was asked for
};

// The run with the same steps of programs and no arrivals, where the system at rest has one that
// violates the property; else one that a check of the property finds there, if it finds one.
// `property` may be empty: then any run with the same steps will do, and no other. Throws
// Interrupted.
std::optional<RestingRun> find_run_at_rest(const System& system, const std::string& property,
                                           const Trace& trace, const System& at_rest,
                                           const RunControl& control);

// What is late: "a late message (at step 5 a message is on its way from server to map)".
std::string describe_late_message(const System& system, const Trace& trace);

}  // namespace maide
