#include "maide/base/source_excerpt.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace maide {
namespace {

constexpr std::size_t most_before = 70, most_after = 30;  // bytes of the line around the place
constexpr int most_lines = 10'000'000;

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }  // of UTF-8

}  // namespace

std::string source_excerpt(const SourcePosition& position) {
  if (position.line < 1 || position.line > most_lines || position.column < 1) return "";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(position.file, ignored)) return "";  // a pipe is read once
  std::ifstream file(position.file);
  std::string line;
  for (int number = 0; number < position.line; ++number) {
    if (!std::getline(file, line)) return "";
  }
  while (!line.empty() && line.back() == '\r') line.pop_back();
  std::size_t place = static_cast<std::size_t>(position.column) - 1;
  if (place > line.size()) return "";
  std::size_t first = place > most_before ? place - most_before : 0;
  while (first < place && is_continuation(line[first])) ++first;
  std::size_t last = std::min(line.size(), place + most_after);
  while (last < line.size() && is_continuation(line[last])) ++last;
  line = line.substr(first, last - first);
  place -= first;
  std::string below;  // one column a character; tabs stay tabs
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (static_cast<unsigned char>(line[at]) < 32 && line[at] != '\t') line[at] = '?';
    if (at < place && !is_continuation(line[at])) below += line[at] == '\t' ? '\t' : ' ';
  }
  return "  " + line + "\n  " + below + "^\n";
}

}  // namespace maide
