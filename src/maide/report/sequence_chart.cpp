#include "maide/report/sequence_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/report/html_report.hpp"

namespace maide {
namespace {

constexpr int margin = 16;
constexpr int number_width = 36;  // the column of steps' numbers
constexpr int place_width = 94;   // that column and the one of line numbers
constexpr int lane_width = 164;
constexpr int row_height = 26;
constexpr int head_height = 28;

// What the message is the arrival or the loss of; null: it is something of its own.
const SequenceChart::Passage* passage_ended_by(const SequenceChart& chart, std::size_t index) {
  const SequenceChart::Message& message = chart.messages[index];
  const auto place =
      std::ranges::find_if(chart.passages, [&](const SequenceChart::Passage& passage) {
        return passage.ended == index && passage.from == message.from && passage.to == message.to;
      });
  return place == chart.passages.end() ? nullptr : &*place;
}

class Drawing {
 public:
  Drawing(std::ostream& out, const SequenceChart& chart, std::size_t most)
      : out_(out), chart_(chart), rows_(fold_chart(chart, most)) {
    top_ = margin + (chart.title.empty() ? 0 : row_height);
    const std::size_t rows = rows_.size() + (chart.loop_start ? 1 : 0);
    bottom_ = top_ + head_height + static_cast<int>(rows + 1) * row_height;
  }

  void draw() {
    open();
    draw_lanes();
    int y = top_ + head_height + row_height;
    std::optional<int> loop_y;
    draw_passages(y);
    for (const ChartRow& row : rows_) {
      if (chart_.loop_start && row.message >= *chart_.loop_start && !loop_y) loop_y = y;
      row.remark.empty() ? draw_message(row.message, y) : draw_remark(row.remark, y);
      y += row_height;
    }
    if (chart_.loop_start) draw_loop(loop_y.value_or(y - row_height), y);
    for (const SequenceChart::Note& note : chart_.notes) draw_note(note);
    out_ << "</svg>\n";
  }

 private:
  int x(std::size_t lane) const {
    return margin + place_width + static_cast<int>(lane) * lane_width + lane_width / 2;
  }

  void open() {
    const int width = 2 * margin + place_width + static_cast<int>(chart_.lanes.size()) * lane_width;
    const int height = bottom_ + (chart_.notes.empty() ? 0 : head_height) + margin;
    out_ << fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
        "viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"13\">\n"
        "<defs><marker id=\"arrow\" markerWidth=\"9\" markerHeight=\"8\" refX=\"8\" refY=\"4\" "
        "orient=\"auto\"><path d=\"M0,0 L9,4 L0,8 z\" fill=\"#1f5fa8\"/></marker></defs>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        width, height);
    if (!chart_.title.empty()) {
      out_ << fmt::format("<text x=\"{}\" y=\"{}\" font-weight=\"bold\">{}</text>\n", margin,
                          margin + 12, escape_markup(chart_.title));
    }
  }

  void draw_lanes() {
    for (std::size_t i = 0; i < chart_.lanes.size(); ++i) {
      const auto& lane = chart_.lanes[i];
      out_ << fmt::format(
          "<line x1=\"{0}\" y1=\"{1}\" x2=\"{0}\" y2=\"{2}\" stroke=\"#999999\" "
          "stroke-dasharray=\"4 3\"/>\n",
          x(i), top_ + head_height, bottom_);
      draw_box(x(i), top_, lane.name, lane.is_model ? "#e8f0fa" : "#f4f4f4",
               lane.is_model ? 10 : 0);
    }
  }

  void draw_box(int center, int y, std::string_view text, std::string_view fill, int radius) {
    out_ << fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\" fill=\"{}\" "
        "stroke=\"#666666\"/>\n<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
        center - lane_width / 2 + 6, y, lane_width - 12, head_height - 4, radius, fill, center,
        y + 16, escape_markup(text));
  }

  void draw_message(std::size_t index, int y) {
    const SequenceChart::Message& message = chart_.messages[index];
    draw_small(margin, y, fmt::format("{}", index + 1));
    if (!message.place.empty()) draw_small(margin + number_width, y, message.place);
    const int from = x(message.from);
    if (passage_ended_by(chart_, index) != nullptr) {  // whose line comes from above
      const bool goes_left = message.to < message.from;
      draw_remark_beside(x(message.to) + (goes_left ? -6 : 6), y, message.remark, goes_left);
      return;
    }
    if (message.from == message.to) {
      out_ << fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\" fill=\"#1f5fa8\"/>\n", from, y);
      draw_label(from + 8, begins_passage(index) ? y - 5 : y + 4, message.label, "start");
      return;
    }
    out_ << fmt::format(
        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"#1f5fa8\" stroke-width=\"1.4\" "
        "marker-end=\"url(#arrow)\"/>\n",
        from, y, x(message.to), y);
    // Beside the sender's lifeline, so that labels of long arrows do not hide other lifelines.
    const int direction = message.to > message.from ? 1 : -1;
    draw_label(from + direction * lane_width / 2, y - 5, message.label, "middle");
    draw_remark_beside(std::max(from, x(message.to)) + 6, y, message.remark, false);
  }

  void draw_remark_beside(int at, int y, const std::string& remark, bool at_its_left) {
    if (remark.empty()) return;
    out_ << fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"11\"{} fill=\"#b00000\">{}</text>\n",
                        at, y + 4, at_its_left ? " text-anchor=\"end\"" : "",
                        escape_markup(remark));
  }

  bool begins_passage(std::size_t index) const {
    return std::ranges::any_of(chart_.passages, [&](const SequenceChart::Passage& passage) {
      return passage.sent == index;
    });
  }

  // From the row of the sending to that of the end, those that are drawn. A sending that is not
  // drawn is somewhere above, an arrival that is not drawn somewhere below.
  void draw_passages(int first_y) {
    std::map<std::size_t, int> places;  // by message
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      if (!rows_[row].remark.empty()) continue;
      places[rows_[row].message] = first_y + static_cast<int>(row) * row_height;
    }
    for (const SequenceChart::Passage& passage : chart_.passages) {
      const auto sent = places.find(passage.sent);
      const auto ended = passage.ended ? places.find(*passage.ended) : places.end();
      if (sent == places.end() && ended == places.end()) continue;
      const bool is_open = ended == places.end();
      const int begin = sent != places.end() ? sent->second : ended->second - row_height;
      const int end = !is_open        ? ended->second
                      : passage.ended ? begin + row_height
                                      : bottom_ - row_height / 2;
      draw_passage(passage, begin, end, is_open);
    }
  }

  void draw_passage(const SequenceChart::Passage& passage, int begin, int end, bool is_open) {
    const bool arrives = !is_open && !passage.is_lost;
    const int from = x(passage.from), to = x(passage.to);
    const int stop = arrives ? to : from + (to - from) * 2 / 3;
    out_ << fmt::format(
        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"#1f5fa8\" "
        "stroke-width=\"1.4\"{}/>\n",
        from, begin, stop, end,
        arrives ? " marker-end=\"url(#arrow)\"" : " stroke-dasharray=\"5 3\"");
    if (is_open || !passage.is_lost) return;
    out_ << fmt::format(
        "<path d=\"M{},{} l8,8 m0,-8 l-8,8\" stroke=\"#b00000\" stroke-width=\"1.6\"/>\n", stop - 4,
        end - 4);
  }

  void draw_small(int at, int y, std::string_view text) {
    out_ << fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"11\" fill=\"#777777\">{}</text>\n", at,
                        y + 4, escape_markup(text));
  }

  void draw_label(int at, int y, std::string_view text, std::string_view anchor) {
    out_ << fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" fill=\"#1f5fa8\">{}</text>\n",
                        at, y, anchor, escape_markup(text));
  }

  // A line of text in place of messages; the lifelines are left open behind it.
  void draw_remark(const std::string& remark, int y) {
    const int left = margin + place_width;
    const int width = static_cast<int>(chart_.lanes.size()) * lane_width;
    out_ << fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#ffffff\"/>\n"
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-style=\"italic\" "
        "fill=\"#777777\">{}</text>\n",
        left, y - 12, width, 18, left + width / 2, y + 2, escape_markup(remark));
  }

  void draw_loop(int begin, int end) {
    const int left = margin + place_width - 8;
    out_ << fmt::format(
        "<path d=\"M{0},{1} h-6 v{2} h6\" fill=\"none\" stroke=\"#b04a00\" stroke-width=\"1.6\"/>\n"
        "<text x=\"{3}\" y=\"{4}\" fill=\"#b04a00\">repeats for ever</text>\n",
        left, begin - 14, std::max(end - begin, row_height), margin, end + 8);
  }

  void draw_note(const SequenceChart::Note& note) {
    draw_box(x(note.lane), bottom_, note.text, "#fdeaea", 0);
  }

  std::ostream& out_;
  const SequenceChart& chart_;
  std::vector<ChartRow> rows_;
  int top_ = 0, bottom_ = 0;
};

}  // namespace

void write_sequence_chart_svg(std::ostream& out, const SequenceChart& chart,
                              std::size_t most_rows) {
  Drawing(out, chart, most_rows).draw();
}

namespace {

constexpr std::size_t longest_round = 500;

// Numbers for messages, equal for those that look alike.
std::vector<std::size_t> number_messages(const SequenceChart& chart) {
  using Look = std::tuple<std::size_t, std::size_t, std::string, std::string, std::string>;
  std::map<Look, std::size_t> numbers;
  std::vector<std::size_t> result;
  for (const SequenceChart::Message& message : chart.messages) {
    const Look look{message.from, message.to, message.label, message.place,
                    message.counted.empty() ? message.remark : message.counted};
    result.push_back(numbers.try_emplace(look, numbers.size()).first->second);
  }
  return result;
}

std::string describe_steps(std::size_t begin, std::size_t end) {
  return end - begin == 1 ? fmt::format("step {}", end)
                          : fmt::format("steps {} to {}", begin + 1, end);
}

class Folder {
 public:
  explicit Folder(const SequenceChart& chart) : chart_(chart), numbers_(number_messages(chart)) {}

  void fold(std::size_t begin, std::size_t end, std::vector<ChartRow>& rows) const {
    for (std::size_t at = begin; at < end;) {
      const Repetition best = find_repetition(at, end);
      if (best.rounds < 2) {
        rows.push_back({at++, ""});
        continue;
      }
      fold(at, at + best.period, rows);
      const std::size_t stop = at + best.period * best.rounds;
      rows.push_back(
          {at, fmt::format("{} again, {} times, to step {}{}", describe_steps(at, at + best.period),
                           best.rounds - 1, stop, describe_counts(at, best.period, stop))});
      at = stop;
    }
  }

 private:
  struct Repetition {
    std::size_t period = 1, rounds = 1;
    // Rows that folding it saves, one being the remark.
    std::size_t saved() const { return rounds < 3 ? 0 : (rounds - 1) * period - 1; }
  };

  // What numbers that count on have become in the last round: ": n = 21".
  std::string describe_counts(std::size_t at, std::size_t period, std::size_t stop) const {
    std::vector<std::string> last;
    for (std::size_t i = 0; i < period; ++i) {
      const std::string& remark = chart_.messages[stop - period + i].remark;
      if (remark != chart_.messages[at + i].remark) last.push_back(remark);
    }
    return last.empty() ? "" : ": " + join(last);
  }

  // The repetition from `at` on that saves most; the shortest period of those.
  Repetition find_repetition(std::size_t at, std::size_t end) const {
    Repetition best;
    const std::size_t most = std::min((end - at) / 3, longest_round);
    for (std::size_t period = 1; period <= most; ++period) {
      std::size_t same = at + period;
      while (same < end && numbers_[same] == numbers_[same - period]) ++same;
      const Repetition candidate{period, (same - at) / period};
      if (candidate.saved() > std::max<std::size_t>(best.saved(), 1)) best = candidate;
    }
    return best;
  }

  const SequenceChart& chart_;
  std::vector<std::size_t> numbers_;
};

// Leaves out the middle of too many rows.
void shorten(const SequenceChart& chart, std::size_t most, std::vector<ChartRow>& rows) {
  if (rows.size() <= most) return;
  const std::size_t head = most / 2, tail = most - head - 1;
  const std::size_t first = rows[head].message, last = rows[rows.size() - tail].message;
  const bool has_loop = chart.loop_start && first <= *chart.loop_start && *chart.loop_start < last;
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(head),
             rows.end() - static_cast<std::ptrdiff_t>(tail));
  const std::string remark = fmt::format(
      "{} not shown{}", describe_steps(first, last),
      has_loop ? fmt::format("; the loop begins at step {}", *chart.loop_start + 1) : "");
  rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(head), {first, remark});
}

}  // namespace

std::vector<ChartRow> fold_chart(const SequenceChart& chart, std::size_t most) {
  const Folder folder(chart);
  std::vector<ChartRow> rows;
  const std::size_t count = chart.messages.size();
  const std::size_t split = chart.loop_start.value_or(count);
  folder.fold(0, split, rows);
  folder.fold(split, count, rows);
  shorten(chart, std::max<std::size_t>(most, 4), rows);
  return rows;
}

Characters to_characters(std::string_view utf8) {
  Characters result;
  while (!utf8.empty()) {
    const char32_t character = take_character(utf8).value_or(U'?');
    result += is_control(character) ? U'?' : character;
  }
  return result;
}

Characters clip(Characters text, std::size_t most, bool unicode) {
  if (text.size() <= most) return text;
  const Characters dots = unicode ? U"…" : U"...";
  if (most <= dots.size()) return text.substr(0, most);
  return text.substr(0, most - dots.size()) + dots;
}

std::string wrap(std::string_view utf8, std::size_t width, std::size_t indent) {
  const Characters text = to_characters(utf8);
  std::string result;
  Characters line(indent, U' ');
  for (std::size_t at = text.find_first_not_of(U' '); at < text.size();
       at = text.find_first_not_of(U' ', at)) {
    const std::size_t end = std::min(text.find(U' ', at), text.size());
    const bool is_first = line.size() == indent;
    if (!is_first && line.size() + 1 + (end - at) > width) {
      result += to_utf8(line) + "\n";
      line.assign(indent, U' ');
    } else if (!is_first) {
      line += U' ';
    }
    line += text.substr(at, end - at);
    at = end;
  }
  return line.size() == indent ? result : result + to_utf8(line) + "\n";
}

namespace {

// The characters of which the chart is drawn.
struct Glyphs {
  char32_t lifeline, line, right, left, crossing, dot, top, side, bottom, late, lost;
};
constexpr Glyphs ascii{'|', '-', '>', '<', '+', '*', '+', '|', '+', '.', 'x'};
constexpr Glyphs line_drawing{U'│', U'─', U'→', U'←', U'┼', U'•', U'┌', U'│', U'└', U'╌', U'×'};

constexpr std::size_t smallest_gap = 8;  // between lifelines
constexpr std::size_t largest_label = 24;

// Where everything stands.
struct Layout {
  explicit Layout(const SequenceChart& chart) {
    number_width = fmt::format("{}", chart.messages.size()).size();
    const std::size_t count = chart.lanes.size();
    std::vector<std::size_t> gaps(count, smallest_gap);  // left of each lane
    const auto name_width = [&](std::size_t lane) {
      return std::min(to_characters(chart.lanes[lane].name).size(), largest_label);
    };
    for (std::size_t lane = 1; lane < count; ++lane) {
      gaps[lane] = std::max(gaps[lane], (name_width(lane - 1) + name_width(lane)) / 2 + 3);
    }
    for (const SequenceChart::Message& message : chart.messages) {
      const std::size_t label = std::min(to_characters(message.label).size(), largest_label);
      // Labels stand beside the sender.
      if (message.to > message.from) {
        gaps[message.from + 1] = std::max(gaps[message.from + 1], label + 6);
      } else if (message.to < message.from) {
        gaps[message.from] = std::max(gaps[message.from], label + 6);
      } else if (message.from + 1 < count) {
        gaps[message.from + 1] = std::max(gaps[message.from + 1], label + 4);
      }
    }
    std::size_t at =
        number_width + 4 + (count > 0 ? std::max<std::size_t>(name_width(0) / 2, 2) : 0);
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (lane > 0) at += gaps[lane];
      lanes.push_back(at);
    }
    width = at + 1;
    if (count > 0) width += (name_width(count - 1) + 1) / 2;
    for (const SequenceChart::Message& message : chart.messages) {
      if (message.from + 1 != count || message.to != message.from) continue;
      width =
          std::max(width, at + 3 + std::min(to_characters(message.label).size(), largest_label));
    }
  }
  std::size_t number_width;
  std::vector<std::size_t> lanes;  // columns
  std::size_t width = 0;           // of all lanes
};

class TextDrawing {
 public:
  TextDrawing(std::ostream& out, const SequenceChart& chart, const ChartTextStyle& style)
      : out_(out),
        chart_(chart),
        style_(style),
        glyphs_(style.unicode ? line_drawing : ascii),
        layout_(chart) {}

  void draw() {
    draw_names();
    const std::vector<ChartRow> rows = fold_chart(chart_, style_.most_rows);
    bool in_loop = false;
    for (const ChartRow& row : rows) {
      const bool begins = !in_loop && chart_.loop_start && row.message >= *chart_.loop_start;
      in_loop = in_loop || begins;
      Characters line(layout_.width, U' ');
      if (in_loop) line[0] = begins ? glyphs_.top : glyphs_.side;
      row.remark.empty() ? draw_message(row.message, line) : draw_remark(row.remark, line);
    }
    if (!in_loop) return;
    Characters line(layout_.width, U' ');
    line[0] = glyphs_.bottom;
    line[1] = glyphs_.line;
    put(line, 3, to_characters("repeats for ever"));
    write(line, "");
  }

 private:
  void put(Characters& line, std::size_t at, const Characters& text) const {
    if (line.size() < at + text.size()) line.resize(at + text.size(), U' ');
    std::ranges::copy(text, line.begin() + static_cast<std::ptrdiff_t>(at));
  }

  Characters clipped(std::string_view text) const {
    return clip(to_characters(text), largest_label, style_.unicode);
  }

  void draw_names() {
    Characters line(layout_.width, U' ');
    for (std::size_t lane = 0; lane < chart_.lanes.size(); ++lane) {
      const Characters name = clipped(chart_.lanes[lane].name);
      put(line, layout_.lanes[lane] - std::min(layout_.lanes[lane], name.size() / 2), name);
    }
    write(line, "");
  }

  void draw_lifelines(Characters& line, char32_t glyph) const {
    for (const std::size_t at : layout_.lanes) line[at] = glyph;
  }

  void draw_message(std::size_t index, Characters& line) {
    const SequenceChart::Message& message = chart_.messages[index];
    draw_lifelines(line, glyphs_.lifeline);
    put(line, 2, to_characters(fmt::format("{:>{}}", index + 1, layout_.number_width)));
    const std::size_t from = layout_.lanes[message.from], to = layout_.lanes[message.to];
    const Characters label = clipped(message.label);
    if (from == to) {
      line[from] = glyphs_.dot;
      put(line, from + 2, label);
    } else {
      draw_arrow(line, from, to, passage_ended_by(chart_, index));
      put(line, to > from ? from + 2 : from - 3 - label.size(), U' ' + label + U' ');
    }
    std::string text = message.remark.empty() ? "" : "(" + message.remark + ")  ";
    text += message.place + (message.source.empty() ? "" : "  " + message.source);
    write(line, text);
  }

  // Dotted where it ends what was sent before.
  void draw_arrow(Characters& line, std::size_t from, std::size_t to,
                  const SequenceChart::Passage* passage) const {
    const std::size_t begin = std::min(from, to), end = std::max(from, to);
    for (std::size_t at = begin + 1; at < end; ++at) {
      const bool crosses = line[at] == glyphs_.lifeline;
      line[at] = crosses ? glyphs_.crossing : passage != nullptr ? glyphs_.late : glyphs_.line;
    }
    char32_t& head = line[to > from ? to - 1 : to + 1];
    head = to > from ? glyphs_.right : glyphs_.left;
    if (passage != nullptr && passage->is_lost) head = glyphs_.lost;
  }

  void draw_remark(const std::string& remark, Characters& line) {
    put(line, 2, to_characters("... " + remark + " ..."));
    write(line, "");
  }

  // Writes the line, and behind it as much of the text as there is room for.
  void write(Characters line, std::string_view text) {
    if (!text.empty() && line.size() + 12 < style_.width) {
      put(line, line.size() + 2,
          clip(to_characters(text), style_.width - line.size() - 2, style_.unicode));
    }
    while (!line.empty() && line.back() == U' ') line.pop_back();
    out_ << to_utf8(line) << '\n';
  }

  std::ostream& out_;
  const SequenceChart& chart_;
  const ChartTextStyle& style_;
  const Glyphs& glyphs_;
  Layout layout_;
};

}  // namespace

bool fits_as_text(const SequenceChart& chart, const ChartTextStyle& style) {
  return Layout(chart).width <= style.width;
}

void write_sequence_chart_text(std::ostream& out, const SequenceChart& chart,
                               const ChartTextStyle& style) {
  TextDrawing(out, chart, style).draw();
}

}  // namespace maide
