// Counterexamples as text and as message sequence charts: who did what, with the lines of the
// system file, and how the programs and models stand in the end. The report of a check as JSON is
// here too.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/base/json.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {

// chart: a message sequence chart. steps: a line a step, with its place and the text that stands
// there. Both fold repetitions (fold_chart()).
enum class TraceFormat : std::uint8_t { chart, steps };

// "node.cpp:12": a place without its folder.
std::string name_of_place(const SourcePosition& place);

// Writes the run, as steps, too, if the chart does not fit.
void write_run_text(std::ostream& out, const System& system, const Trace& trace, TraceFormat format,
                    const ChartTextStyle& style);

// Writes why the run goes on nowhere, and who waits for what: it is cut there, comes to an error,
// to the end of all programs, or to a deadlock. False, and nothing is written, where it is none of
// these.
bool write_standstill(std::ostream& out, const System& system, const GlobalState& state);

// Writes a counterexample, and who waits for what at its end.
void write_trace_text(std::ostream& out, const System& system, const Trace& trace,
                      TraceFormat format = TraceFormat::chart, const ChartTextStyle& style = {});
// Writes a counterexample so, or the run that shows that something is possible.
void write_shown_text(std::ostream& out, const Shown& shown,
                      TraceFormat format = TraceFormat::chart, const ChartTextStyle& style = {});

// The report of `maide check --json`. A result's `component` names the programs whose runs it is
// about; it is null if these are all. A result with a trace has `explanation` and `loop_start`,
// which is null if nothing repeats; one that is inconclusive has `reason`.
Json report_to_json(const System& system, const CheckReport& report);

// A chart has a lane for each program and model, and an arrow for each rendezvous. Below each
// program stands what it waits for in the end. Programs and models that talk much stand side by
// side. A step in which a message was lost has a remark.
// O(steps x programs).
SequenceChart make_trace_chart(const System& system, const Trace& trace, std::string title);

// The chart of a trace as it stands in a file (`maide check --trace`), without its system: the
// steps name programs, models and what happens.
//
// `file` is for messages. The first program comes leftmost, then the models, then the other
// programs, in the order in which they appear. Throws UsageError for what is no trace. O(steps).
SequenceChart chart_of_trace(std::string_view text, const std::string& file);

}  // namespace maide
