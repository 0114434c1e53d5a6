// A message sequence chart for the terminal: a column for each program and model, a line for each
// step, time downwards. Repetitions are folded (chart_rows); the part that repeats for ever is
// bracketed at the left. In line-drawing characters, or in plain ASCII.
#pragma once

#include <cstddef>
#include <iosfwd>

#include "maide/report/sequence_chart.hpp"

namespace maide {

struct ChartTextStyle {
  std::size_t width = 100;  // columns of the terminal
  bool unicode = false;     // UTF-8 in place of ASCII
  std::size_t most_rows = 200;
};

// Whether the lanes of the chart fit into the width.
bool fits_as_text(const SequenceChart& chart, const ChartTextStyle& style);

// The chart's title and notes are not written. At the right of each step, as far as there is room,
// its remark, place and source text. If the lanes do not fit, the lines are wider than asked for.
void write_sequence_chart_text(std::ostream& out, const SequenceChart& chart,
                               const ChartTextStyle& style);

}  // namespace maide
