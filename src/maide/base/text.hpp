// Text as people write and read it: lists, characters of UTF-8, text that others wrote, words of a
// command line, suggestions for misspelt names, tables of named rows, and the line of a file in
// which something is wrong.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {

// The names with the separator between them; "" for none.
inline std::string join(std::span<const std::string> names, std::string_view separator = ", ") {
  std::string text;
  for (const std::string& name : names) {
    if (&name != &names.front()) text += separator;
    text += name;
  }
  return text;
}

// "1 state", "3 states".
inline std::string counted(std::uint64_t count, std::string_view what) {
  return std::to_string(count) + " " + std::string(what) + (count == 1 ? "" : "s");
}

// The parts between separators; one at least, and "" where two meet.
std::vector<std::string_view> split(std::string_view text, char separator);

// The lines without their ends. A line break at the end of the text begins no line.
std::vector<std::string_view> split_lines(std::string_view text);

// ---- Characters of UTF-8 ----

// Takes the character that the text begins with off it. Where the text begins with none, takes one
// byte, and nothing is returned. The text is not empty.
std::optional<char32_t> take_character(std::string_view& text);

// The characters are code points; surrogates are none.
std::string to_utf8(std::u32string_view characters);

// U+0000 to U+001F and U+007F to U+009F.
bool is_control(char32_t character);

// A byte of a character that is not its first.
constexpr bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) >> 6) == 2; }

// ---- Text that others wrote ----
//
// What a wrapper says, or a name in a file, may hold control characters. A control character can
// move the cursor, recolour or erase the text there, even type. So before a terminal gets the text,
// '?' replaces every control character that is not white space, those of Unicode too (U+0080 to
// U+009F), and every byte that is not UTF-8. Text for a file or a program is not changed.

// Keeps lines and tabs.
std::string printable(std::string_view text);

// One line: each line break and tab is a blank.
std::string one_line(std::string_view text);

// ---- Words of a command line ----
//
// Blanks stand between words and quotes around blanks, as in a shell. Nothing is expanded.

// Splits a command line into words: blanks, '...', "...", backslash. Throws UsageError on an
// unclosed quote.
std::vector<std::string> split_shell_words(std::string_view line);

// The word as it is written in a line: in quotes, where split_shell_words() would not give it back.
std::string quote_shell_word(const std::string& word);

// ---- Suggestions ----
//
// "Did you mean ...?" names the known name that is nearest to a misspelt one. Distance counts
// insertions, deletions, substitutions and transpositions of neighbours (F. Damerau, "A technique
// for computer detection and correction of spelling errors", CACM 1964).

// The number of edits that turn `a` into `b`; O(|a| |b|).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The nearest of `known`, the first of them in case of a tie; "" if none is near. A name is near if
// at most one letter has to change, or at most a third of the name's letters.
std::string find_nearest(std::string_view name, std::span<const std::string> known);

// "; did you mean 'depth'?", or "" if nothing is near. To be put behind an error message.
std::string did_you_mean(std::string_view name, std::span<const std::string> known);

// As did_you_mean(); if nothing is near, "; known are: history, depth". A list of fifteen names
// hides the one that was meant, so only one of the two is said.
inline std::string near_or_known(std::string_view name, std::span<const std::string> known) {
  const std::string near = did_you_mean(name, known);
  return near.empty() ? "; known are: " + (known.empty() ? "none" : join(known)) : near;
}

// ---- Tables of named rows ----
//
// Algorithms, methods and formats stand in tables whose rows have a member `name`. What a user
// types finds its row, or an error with the name that is near, or with all.

// "unknown algorithm 'lsherp'; did you mean 'lsharp'?". To be thrown.
inline UsageError unknown_name(std::string_view what, std::string_view name,
                               std::span<const std::string> known) {
  return UsageError("unknown " + std::string(what) + " '" + std::string(name) + "'" +
                    near_or_known(name, known));
}

// The row of this name; throws unknown_name() if there is none. `besides` are names that a user may
// type, too, for that message. O(rows).
template <typename Row>
const Row& find_row(std::span<const Row> table, std::string_view what, std::string_view name,
                    std::initializer_list<std::string_view> besides = {}) {
  std::vector<std::string> known;
  for (const Row& row : table) {
    if (row.name == name) return row;
    known.emplace_back(row.name);
  }
  known.insert(known.end(), besides.begin(), besides.end());
  throw unknown_name(what, name, known);
}

// ---- Places in files ----
//
// The line of a file in which something is wrong, with a caret under the place, as compilers show
// it.

// Two lines, each ended; "" if the place is not known to the column or the file cannot be read.
// Long lines are cut to what stands around the place, and what cannot be printed is a '?'.
std::string source_excerpt(const SourcePosition& position);

}  // namespace maide
