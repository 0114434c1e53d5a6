// Message sequence charts for the terminal: a column for each program and model, a line for each
// step, time downwards. Repetitions are folded (fold_chart()), and the part that repeats for ever
// has a bracket at the left. Charts are drawn with lines, or in plain ASCII. Text in columns,
// clipping and wrapping are here too.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/report/sequence_chart.hpp"

namespace maide {

// ---- Text in columns ----
//
// Names in UTF-8 as characters, one a column. Bytes that are no UTF-8, and control characters,
// become `?`. Wide and combining characters are not treated specially: a column may be off by one
// there.

using Characters = std::u32string;

Characters to_characters(std::string_view utf8);

// At most `most` characters; what is longer ends in "…", or in "..." without `unicode`.
Characters clip(Characters text, std::size_t most, bool unicode);

// The words of the text in lines of at most `width` columns, each begun with `indent` blanks and
// ended with a line break. A word that is longer has a line of its own.
std::string wrap(std::string_view utf8, std::size_t width, std::size_t indent);

// ---- Charts ----
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
