// A counterexample as a message sequence chart: a lane for each program and model, an arrow for
// each rendezvous, and below each program what it waits for in the end.
#pragma once

#include "maide/check/system.hpp"
#include "maide/check/trace.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {

// Programs and models that talk much stand side by side. Messages that a program waits for in the
// end and that were lost have a remark. O(steps x programs).
SequenceChart make_trace_chart(const System& system, const Trace& trace, std::string title);

}  // namespace maide
