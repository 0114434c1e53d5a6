// UTF-8 by the table of well-formed byte sequences (The Unicode Standard, table 3-7).
#include "maide/base/text.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {
namespace {

bool is_between(unsigned byte, unsigned first, unsigned last) {
  return byte >= first && byte <= last;
}

// Bytes of the well-formed character that `text` begins with; 0 if there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t place) -> unsigned {
    return place < text.size() ? static_cast<unsigned char>(text[place]) : 0;
  };
  const unsigned first = byte(0);
  std::size_t length = 0;
  unsigned low = 0x80, high = 0xbf;  // of the second byte
  if (first < 0x80) {
    return 1;
  } else if (is_between(first, 0xc2, 0xdf)) {
    length = 2;
  } else if (is_between(first, 0xe0, 0xef)) {
    length = 3;
    if (first == 0xe0) low = 0xa0;   // else overlong
    if (first == 0xed) high = 0x9f;  // else a surrogate
  } else if (is_between(first, 0xf0, 0xf4)) {
    length = 4;
    if (first == 0xf0) low = 0x90;   // else overlong
    if (first == 0xf4) high = 0x8f;  // else beyond U+10FFFF
  } else {
    return 0;
  }
  if (!is_between(byte(1), low, high)) return 0;
  for (std::size_t place = 2; place < length; ++place) {
    if (!is_between(byte(place), 0x80, 0xbf)) return 0;
  }
  return length;
}

bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 2 && first == 0xc2) {
    return static_cast<unsigned char>(character[1]) < 0xa0;
  }
  return first < 0x20 || first == 0x7f;
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    const bool is_kept =
        character == "\n" || character == "\t" || (length > 0 && !is_control(character));
    result += is_kept ? character : "?";
    text.remove_prefix(character.size());
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
    const std::size_t distance = edit_distance(name, candidate);
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
