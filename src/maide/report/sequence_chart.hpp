// Message sequence charts: one vertical lifeline for each program and model, one arrow for each
// step, time downwards. Here are the chart as data, the folding of what repeats, and the chart as a
// picture (plain SVG 1.1, self-contained, readable on light and dark pages) and for the terminal.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace maide {

struct SequenceChart {
  struct Lane {
    std::string name;
    bool is_model = false;  // models are drawn as rounded boxes, programs as plain ones
  };
  struct Message {
    std::size_t from = 0;  // lanes; equal for a step that one lane makes alone
    std::size_t to = 0;
    std::string label;   // "write", "message"
    std::string place;   // "line 8", shown small at the left; may be empty
    std::string source;  // the text of that line, where there is room for it
    std::string remark;  // what is worth knowing of this very message: "one is lost", "n = 3"
    // The remark with what is added to numbers in place of what they become: "one is lost", "n +
    // 1". Messages whose numbers count on are alike.
    std::string counted{};
    std::size_t step = 0;  // of the run; further steps may lie between two messages
  };
  // What is on its way for a while: drawn from the row of its sending down to that of its arrival.
  // Where it is lost it ends in a cross, and where it is still on its way before it is there.
  struct Passage {
    std::size_t from = 0;  // lanes
    std::size_t to = 0;
    std::size_t sent = 0;                // index of the message that is its sending
    std::optional<std::size_t> ended{};  // of the one that is its arrival or its loss
    bool is_lost = false;
  };
  struct Note {
    std::size_t lane = 0;
    std::string text;  // "waits for via!message"
  };

  std::string title;  // one line above the chart; may be empty
  std::vector<Lane> lanes;
  std::vector<Message> messages;
  std::vector<Passage> passages;
  std::optional<std::size_t> loop_start;  // messages from here on repeat for ever
  std::vector<Note> notes;                // what each lane ends in, below the last message
};

// Writes `chart` as a complete SVG file. Repetitions are folded and at most `most_rows` rows drawn
// (fold_chart()).
void write_sequence_chart_svg(std::ostream& out, const SequenceChart& chart,
                              std::size_t most_rows = 200);

// ---- Folding ----
//
// Which rows of a long chart are drawn. A counterexample of a thousand steps is a few rounds that
// repeat. So a stretch of messages that comes several times in a row is shown once, with a remark
// how often it comes again, and where numbers that count on end. Stretches that differ in anything
// else that a row shows are not folded. So what happens once, such as the message that was lost or
// the last round, stays visible.
struct ChartRow {
  std::size_t message = 0;  // index into the chart's messages
  std::string remark;  // in place of a message: "steps 3 to 6 again, 20 times, to step 86: n = 21"
};

// Rows in order. Repetitions are folded, innermost ones within outer ones; a fold does not reach
// over the start of the loop. If there are still more than `most` rows, the middle is left out with
// a remark that counts its steps. O(messages x longest round), rounds up to 500 messages.
std::vector<ChartRow> fold_chart(const SequenceChart& chart, std::size_t most = 200);

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

// ---- Charts for the terminal ----
//
// A column for each program and model, a line for each step, time downwards. Repetitions are folded
// (fold_chart()), and the part that repeats for ever has a bracket at the left. Charts are drawn
// with lines, or in plain ASCII.

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
