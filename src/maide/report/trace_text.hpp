// A counterexample in words: who did what, with the lines of the system file, and how the programs
// and models stand at its end.
#pragma once

#include <cstdint>
#include <iosfwd>

#include "maide/base/json.hpp"
#include "maide/check/check_system.hpp"
#include "maide/report/sequence_chart_text.hpp"

namespace maide {

// A message sequence chart, or a line a step with its place and the text that stands there. Both
// fold repetitions (chart_rows).
enum class TraceFormat : std::uint8_t { chart, steps };

// Writes the trace - as steps, too, if the chart does not fit - and who waits for what at its end.
void write_trace_text(std::ostream& out, const System& system, const Trace& trace,
                      TraceFormat format = TraceFormat::chart, const ChartTextStyle& style = {});

// The report of `maide check --json`. A result with a trace has `explanation`, and, if the trace
// repeats, `loop_start`; one that is inconclusive has `reason`.
Json report_to_json(const System& system, const CheckReport& report);

}  // namespace maide
