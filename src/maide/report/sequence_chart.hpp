// Message sequence charts as pictures: one vertical lifeline for each program and model, one arrow
// for each step, time downwards. Plain SVG 1.1, self-contained, readable on light and dark pages.
#pragma once

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
    std::string remark;  // what is worth knowing of this very message: "one is lost"
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
// (chart_rows).
void write_sequence_chart_svg(std::ostream& out, const SequenceChart& chart,
                              std::size_t most_rows = 200);

}  // namespace maide
