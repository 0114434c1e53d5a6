#include "maide/report/sequence_chart_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {

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
  char32_t lifeline, line, right, left, crossing, dot, top, side, bottom;
};
constexpr Glyphs ascii{'|', '-', '>', '<', '+', '*', '+', '|', '+'};
constexpr Glyphs line_drawing{U'│', U'─', U'→', U'←', U'┼', U'•', U'┌', U'│', U'└'};

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
    std::copy(text.begin(), text.end(), line.begin() + static_cast<std::ptrdiff_t>(at));
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
      draw_arrow(line, from, to);
      put(line, to > from ? from + 2 : from - 3 - label.size(), U' ' + label + U' ');
    }
    std::string text = message.remark.empty() ? "" : "(" + message.remark + ")  ";
    text += message.place + (message.source.empty() ? "" : "  " + message.source);
    write(line, text);
  }

  void draw_arrow(Characters& line, std::size_t from, std::size_t to) const {
    const std::size_t begin = std::min(from, to), end = std::max(from, to);
    for (std::size_t at = begin + 1; at < end; ++at) {
      line[at] = line[at] == glyphs_.lifeline ? glyphs_.crossing : glyphs_.line;
    }
    line[to > from ? to - 1 : to + 1] = to > from ? glyphs_.right : glyphs_.left;
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
