#include "maide/base/text.hpp"

#include <utf8.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> split_lines(std::string_view text) {
  std::vector<std::string_view> lines = split(text, '\n');
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

std::optional<char32_t> take_character(std::string_view& text) {
  constexpr std::size_t longest = 4;
  const char* const begin = text.data();
  const bool is_good = utf8::find_invalid(begin, begin + std::min(text.size(), longest)) != begin;
  const char* end = begin;
  std::optional<char32_t> character;
  if (is_good) character = static_cast<char32_t>(utf8::unchecked::next(end));
  text.remove_prefix(is_good ? static_cast<std::size_t>(end - begin) : 1);
  return character;
}

std::string to_utf8(std::u32string_view characters) {
  std::string text;
  for (const char32_t character : characters) {
    utf8::append(character, std::back_inserter(text));
  }
  return text;
}

bool is_control(char32_t character) {
  return character < 0x20 || (character >= 0x7f && character < 0xa0);
}

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::string_view before = text;
    const std::optional<char32_t> character = take_character(text);
    // NOLINTNEXTLINE(misc-redundant-expression): clang-tidy 14 takes '\n' and '\t' for one
    const bool is_blank = character == U'\n' || character == U'\t';
    const bool is_kept = is_blank || (character && !is_control(*character));
    result += is_kept ? before.substr(0, before.size() - text.size()) : "?";
  }
  return result;
}

std::string one_line(std::string_view text) {
  std::string blanks(text);
  std::replace_if(
      blanks.begin(), blanks.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; },
      ' ');
  return printable(blanks);
}

std::vector<std::string> split_shell_words(std::string_view line) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool is_blank = c == ' ' || c == '\t' || c == '\n';
    if (quote == 0 && is_blank) {
      in_word = false;
      continue;
    }
    if (!in_word) words.emplace_back();
    in_word = true;
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == '\\' && quote != '\'' && i + 1 < line.size()) {
      const char next = line[i + 1];
      const bool is_escape = quote == 0 || next == '"' || next == '\\';
      words.back() += is_escape ? next : c;
      if (is_escape) ++i;
    } else {
      words.back() += c;
    }
  }
  if (quote != 0) {
    throw UsageError(std::string("a quote ") + quote + " is not closed in '" + std::string(line) +
                     "'");
  }
  return words;
}

std::string quote_shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n'\"\\") == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

namespace {

std::string to_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

}  // namespace

// The "optimal string alignment" form of Damerau's distance: no letter is edited twice.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

std::string find_nearest(std::string_view name, std::span<const std::string> known) {
  constexpr std::size_t longest_worth_comparing = 100;
  if (name.empty() || name.size() > longest_worth_comparing) return {};
  std::size_t best = std::max<std::size_t>(1, name.size() / 3) + 1;
  std::string nearest;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(to_lower(name), to_lower(candidate));
    // A name with every letter changed is another name, however short.
    if (distance < best && distance < std::max(name.size(), candidate.size())) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> known) {
  const std::string nearest = find_nearest(name, known);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

namespace {

constexpr std::size_t most_before = 70, most_after = 30;  // bytes of the line around the place
constexpr int most_lines = 10'000'000;

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
  if (position.line == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
  while (!line.empty() && line.back() == '\r') line.pop_back();
  std::size_t place = static_cast<std::size_t>(position.column) - 1;
  if (place > line.size()) return "";
  while (place > 0 && place < line.size() && is_continuation(line[place])) --place;
  std::size_t first = place > most_before ? place - most_before : 0;
  while (first < place && is_continuation(line[first])) ++first;
  std::size_t last = std::min(line.size(), place + most_after);
  while (last < line.size() && is_continuation(line[last])) ++last;
  const std::string before = printable(std::string_view(line).substr(first, place - first));
  std::string below;  // one column a character; tabs stay tabs
  for (const char c : before) {
    if (!is_continuation(c)) below += c == '\t' ? '\t' : ' ';
  }
  const std::string after = printable(std::string_view(line).substr(place, last - place));
  return "  " + before + after + "\n  " + below + "^\n";
}

}  // namespace maide
