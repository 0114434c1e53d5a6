// One style for system files: `maide format`. Texts are not parsed for their meaning, so no model
// is needed, and a program that is wrong can be laid out, too. What is kept: every word and sign,
// in its order, every comment, which statements share a line, and whether a map stands in braces.
// What is made alike: blanks, indentation, where lines break, quotes around programs and formulas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/text/scalar_text.hpp"

namespace maide {

inline constexpr std::size_t layout_width = 100;  // of a line, in bytes

// A line of text with the comment at its end, which has its signs (`# ...`), or "".
struct LaidLine {
  std::string text;
  std::string comment;
};

// The lines of a program, of a procedure or of variables. A block that stands on one line stays
// there if it fits in `width`. Throws ParseError for braces that do not match.
std::vector<LaidLine> lay_out_program(const ScalarText& program, std::size_t width);

// A formula or an expression on one line; comments are left out.
std::string lay_out_formula(const ScalarText& formula);

// The words and signs of a program or a formula, and its comments: what a layout keeps.
struct ProgramWords {
  std::vector<std::string> words, comments;
  bool operator==(const ProgramWords&) const = default;
};
ProgramWords words_of(std::string_view text);

// What a text of a system file is, by the keys that lead to it.
enum class TextMeaning : std::uint8_t { other, program, formula };
TextMeaning meaning_of(const std::vector<std::string>& path);

// The lines as text. Comments of neighbouring lines with one indentation stand below one another
// where they fit.
std::vector<std::string> align_comments(const std::vector<LaidLine>& lines, std::size_t width);

// The whole file. Throws ParseError if it is not YAML, or a program's braces do not match. What
// YAML has beyond maps, lists and texts (anchors, tags, lists with dashes) is left as it stands.
std::string lay_out_system(std::string_view text, const std::string& file);

}  // namespace maide
