// A counterexample as a message sequence chart: a lane for each program and model, an arrow for
// each rendezvous, and below each program what it waits for in the end.
#pragma once

#include "maide/check/system.hpp"
#include "maide/check/trace.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {

// The first program comes leftmost, then the models, then the other programs. O(steps).
SequenceChart make_trace_chart(const System& system, const Trace& trace, std::string title);

}  // namespace maide
