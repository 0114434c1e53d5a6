// Runs of a system with messages on their way, as runs on real connections that come to rest
// between any two steps. Nobody can hold a message back there, so a run that needs a late one
// cannot be played. What is played is a run of the system at rest (Deliveries), whose programs do
// the same.
#pragma once

#include <optional>
#include <string>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

// The run with the same steps of programs and no arrivals; none if the system at rest has no such
// run, or one that does not violate the property. `property` may be empty: then any will do.
std::optional<Trace> trace_at_rest(const System& system, const std::string& property,
                                   const Trace& trace, const System& at_rest);

// Why there is none: "not tried: needs a late message (at step 5 a message is on its way from
// server to map)".
std::string describe_late_message(const System& system, const Trace& trace);

}  // namespace maide
