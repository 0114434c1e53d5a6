// A counterexample in words: who did what, with the lines of the system file, and how the programs
// and models stand at its end.
#pragma once

#include <iosfwd>

#include "maide/base/json.hpp"
#include "maide/check/check_system.hpp"

namespace maide {

// Writes the trace, of which at most `most_steps` steps are shown: the middle is left out with a
// line that counts them.
void write_trace_text(std::ostream& out, const System& system, const Trace& trace,
                      std::size_t most_steps = 200);

// [{"program", "line", "model", "event"}, ...]: events are "?input", "!output", "quiet", and, with
// model null, "if" and "else" for the branches of an `if *`.
Json trace_to_json(const System& system, const Trace& trace);

// The report of `maide check --json`. A result with a trace that repeats has `loop_start`; one that
// is inconclusive has `reason`.
Json report_to_json(const System& system, const CheckReport& report);

}  // namespace maide
