// Message sequence charts: one vertical lifeline for each program and model, one arrow for each
// step, time downwards. Here are the chart as data, the folding of what repeats, and the chart as a
// picture: plain SVG 1.1, self-contained, readable on light and dark pages.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
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
  };
  struct Note {
    std::size_t lane = 0;
    std::string text;  // "waits for via!message"
  };

  std::string title;  // one line above the chart; may be empty
  std::vector<Lane> lanes;
  std::vector<Message> messages;
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
// how often it comes again. Stretches that differ in anything that a row shows are not folded. So
// what happens once, such as the message that was lost or the last round, stays visible.
struct ChartRow {
  std::size_t message = 0;  // index into the chart's messages
  std::string remark;       // in place of a message: "steps 3 to 6 again, 20 times, to step 86"
};

// Rows in order. Repetitions are folded, innermost ones within outer ones; a fold does not reach
// over the start of the loop. If there are still more than `most` rows, the middle is left out with
// a remark that counts its steps. O(messages x longest round), rounds up to 500 messages.
std::vector<ChartRow> fold_chart(const SequenceChart& chart, std::size_t most = 200);

}  // namespace maide
