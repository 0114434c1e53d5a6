#include "maide/cli/terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <string>

#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide::cli {
namespace {

std::atomic<ColorMode> color_mode{ColorMode::automatic};

bool gets_colors(int descriptor) {
  if (color_mode != ColorMode::automatic) return color_mode == ColorMode::always;
  const char* no_color = std::getenv("NO_COLOR");
  if (no_color != nullptr && *no_color != '\0') return false;
  const char* terminal = std::getenv("TERM");
  return ::isatty(descriptor) == 1 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

// The tone's code of "Select Graphic Rendition" (ECMA-48).
std::string_view code_of(Tone tone) {
  switch (tone) {
    case Tone::plain: return "";
    case Tone::good: return "32";
    case Tone::bad: return "31";
    case Tone::doubtful: return "33";
    case Tone::heading: return "1";
  }
  return "";
}

std::size_t columns(std::string_view text) { return to_characters(text).size(); }

// Where what follows a broken line stands.
std::size_t indent_below(std::string_view line, std::size_t width) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", begin);
  const std::size_t text = gap == std::string_view::npos ? gap : line.find_first_not_of(' ', gap);
  constexpr std::size_t longest_label = 24;
  if (text > longest_label || text * 2 > width) return begin + 2;  // or there is none
  return columns(line.substr(0, text));
}

}  // namespace

void set_color_mode(ColorMode mode) { color_mode = mode; }

std::string paint(std::string_view text, Tone tone, int descriptor) {
  std::string plain = printable(text);
  const std::size_t length = plain.find_last_not_of('\n') + 1;  // 0 if there is nothing else
  if (tone == Tone::plain || length == 0 || !gets_colors(descriptor)) return plain;
  return "\033[" + std::string(code_of(tone)) + "m" + plain.substr(0, length) + "\033[0m" +
         plain.substr(length);
}

std::size_t help_width() {
  return std::clamp<std::size_t>(terminal_width(STDOUT_FILENO).value_or(80), 40, 80);
}

std::string wrap_lines(std::string_view text, std::size_t width) {
  std::string result;
  for (const std::string_view line : split_lines(text)) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (columns(line) <= width || begin == std::string_view::npos) {
      result += std::string(line) + "\n";
      continue;
    }
    const std::size_t indent = indent_below(line, width);
    // The first line keeps its blanks: it is broken off by hand, the rest by wrap().
    const Characters characters = to_characters(line);
    std::size_t end = characters.rfind(U' ', width);
    if (end == Characters::npos || end < indent)
      end = characters.find(U' ', std::max(indent, width));
    if (end == Characters::npos) end = characters.size();
    result += to_utf8(characters.substr(0, end)) + "\n";
    result += wrap(to_utf8(characters.substr(end)), width, indent);
  }
  if (!text.ends_with('\n') && !result.empty()) result.pop_back();
  return result;
}

std::string two_columns(const std::vector<TextRow>& rows, std::size_t width, std::size_t most) {
  std::size_t column = 0;
  for (const auto& [name, text] : rows) {
    if (columns(name) <= most) column = std::max(column, columns(name));
  }
  const std::size_t indent = column + 4;
  std::string result;
  for (const auto& [name, text] : rows) {
    std::string below = wrap(text, width, indent);
    std::string first = "  " + name;
    if (columns(name) <= column && !below.empty()) {
      first += below.substr(columns(first));
      result += first;
    } else {
      result += first + "\n" + below;
    }
  }
  return result;
}

}  // namespace maide::cli
