// One style for the texts of programs and formulas. What is kept: every word and sign, in its
// order, every comment, and which statements share a line. What is made alike: blanks, indentation,
// where lines break.
//
//   loop{repeat 6{via.write;}}   becomes   loop { repeat 6 { via.write; } }
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/check/text/scalar_text.hpp"

namespace maide {

// A line of text with the comment at its end, which has its sign (`# ...`), or "".
struct LaidLine {
  std::string text;
  std::string comment;
};

// The lines of a text that parses: a program, a procedure, variables. A block that stands on one
// line stays there if it fits in `width`.
std::vector<LaidLine> lay_out_program(const ScalarText& program, std::size_t width);

// A formula or an expression on one line; comments are left out.
std::string lay_out_formula(const ScalarText& formula);

// The lines as text. Comments of neighbouring lines with one indentation stand below one another
// where they fit.
std::vector<std::string> align_comments(const std::vector<LaidLine>& lines, std::size_t width);

// Whether both have the same words, signs and comments in the same order.
bool has_same_words(const ScalarText& one, const ScalarText& other);
bool has_comments(const ScalarText& text);

}  // namespace maide
