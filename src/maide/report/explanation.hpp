// A counterexample in one sentence of plain words: who waits for what, what became of it, and who
// could still change that. Made from facts alone (check/waiting, check/message_account), for any
// system: nothing is known here of particular middlewares.
#pragma once

#include <string>

#include "maide/check/system.hpp"
#include "maide/check/trace.hpp"

namespace maide {

// "controller waits at line 13 for message 2 of 6 from via, which holds none: planner wrote 6, 1
// was read and 5 were lost, ...". Without a full stop. `trace` is a counterexample for `property`.
// O(steps x programs).
std::string explain(const System& system, const Property& property, const Trace& trace);

}  // namespace maide
