// Recursive descent over the program language, from a text to its tree (code.hpp). Nothing is asked
// about what a name means, so a text is parsed before any model is known, and once. The grammar
// stands in code_parser.cpp's head; docs/systems.md says what it means.
#pragma once

#include <string>
#include <vector>

#include "maide/check/language/code.hpp"
#include "maide/check/text/scalar_text.hpp"

namespace maide::syntax {

// A keyword of statements: it begins one, or stands inside of one.
bool is_reserved(const Name& word);

// Names of the file, for messages alone: what a word may be that begins no statement.
struct KnownNames {
  std::vector<std::string> procedures, variables, constants, models;
};

// Each throws ParseError with the place of the slip.
Code parse_program(const ScalarText& text, const KnownNames& names = {});    // not empty
Code parse_callback(const ScalarText& text, const KnownNames& names = {});   // not empty
Code parse_procedure(const ScalarText& text, const KnownNames& names = {});  // may be empty
Code parse_variables(const ScalarText& text);                                // declarations alone
Term parse_expression(const ScalarText& text);
Timer parse_timer(const ScalarText& text);
Taken parse_taken(const ScalarText& text);
Event parse_output(const ScalarText& text);
Declared parse_declared(const ScalarText& text);
Head parse_head(const ScalarText& text);
Reference parse_reference(const ScalarText& text);
Formula parse_formula(const ScalarText& text);

}  // namespace maide::syntax
