// Message sequence charts of counterexamples. A chart has a lane for each program and model, and an
// arrow for each rendezvous. Below each program stands what it waits for in the end. A chart is
// made from a trace and its system, or from a trace file alone.
#pragma once

#include <string>
#include <string_view>

#include "maide/check/language/system.hpp"
#include "maide/check/trace/trace.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {

// Programs and models that talk much stand side by side. Messages that a program waits for in the
// end and that were lost have a remark. O(steps x programs).
SequenceChart make_trace_chart(const System& system, const Trace& trace, std::string title);

// The chart of a trace as it stands in a file (`maide check --trace`), without its system: the
// steps name programs, models and what happens.
//
// `file` is for messages. The first program comes leftmost, then the models, then the other
// programs, in the order in which they appear. Throws UsageError for what is no trace. O(steps).
SequenceChart chart_of_trace(std::string_view text, const std::string& file);

}  // namespace maide
