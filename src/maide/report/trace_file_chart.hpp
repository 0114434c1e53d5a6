// The message sequence chart of a trace as it stands in a file (`maide check --trace`), without the
// system that it is of: its steps name programs, models and what happens.
#pragma once

#include <string>
#include <string_view>

#include "maide/report/sequence_chart.hpp"

namespace maide {

// `file` is for messages. The first program comes leftmost, then the models, then the other
// programs, in the order in which they appear. Throws UsageError for what is no trace. O(steps).
SequenceChart chart_of_trace(std::string_view text, const std::string& file);

}  // namespace maide
