// Which rows of a long chart are drawn. A counterexample of a thousand steps is a few rounds that
// repeat: a stretch of messages that comes several times in a row is shown once, with a remark how
// often it comes again. Nothing is folded that differs in anything a row shows, so what happens
// once - the message that was lost, the last round - stays visible.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/report/sequence_chart.hpp"

namespace maide {

struct ChartRow {
  std::size_t message = 0;  // index into the chart's messages
  std::string remark;       // in place of a message: "steps 3 to 6 again, 20 times, to step 86"
};

// Rows in order. Repetitions are folded, innermost ones within outer ones; a fold does not reach
// over the start of the loop. If there are still more than `most` rows, the middle is left out with
// a remark that counts its steps. O(messages x longest round), rounds up to 500 messages.
std::vector<ChartRow> fold_chart(const SequenceChart& chart, std::size_t most = 200);

}  // namespace maide
