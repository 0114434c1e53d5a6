// Expressions and formulas: one precedence climber over a table of levels (M. Richards and C.
// Whitby-Strevens, "BCPL: the language and its compiler", 1979), with a table for each of the two.
//
//   expressions  n + 1 < 3 && !ok      `!` binds strongest
//   formulas     !n + 1 < 3 && G ok    `!` takes all of `n + 1 < 3`
//
// A word of formulas, as `F`, is the operator unless `@`, `.` or `:` stands behind it: `F !a!b` is
// "finally not", and a model named F is put in quotes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "maide/check/language/code.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide::syntax {

class TermParser {
 public:
  // Keeps a reference to the tokens.
  explicit TermParser(TokenStream& tokens) : tokens_(tokens) {}

  // Throw ParseError: no expression stands there, or it is nested more than 200 deep.
  Term parse();          // all operators of expressions
  Term parse_sum();      // `+ - * / %` alone: a bound, an index
  Term parse_formula();  // all operators of formulas; names with their parts
  // LOW..HIGH.
  Range parse_range();
  // A name and what stands in brackets behind it.
  Term parse_name();
  // "i in 0..4, k in 1..2". `as_in`: an example for messages, "[i in 0..4]".
  std::vector<Index> parse_index_list(std::string_view as_in);

  // Throws if the token is an operator of other languages, or of other logics.
  void fail_foreign(const Token& token) const;

 private:
  enum class Grammar : std::uint8_t { expression, formula };

  Term parse_all(Grammar grammar, std::size_t weakest);
  Term parse_level(Grammar grammar, std::size_t weakest);
  Term parse_primary(Grammar grammar);
  Term parse_brackets(Grammar grammar, const Token& open);
  Term parse_name_behind(Grammar grammar, const Token& name);
  // "[i, j + 1]", if it stands there.
  bool parse_indices(std::vector<Term>& indices, Grammar grammar);
  void parse_parts(Term& term);
  void parse_values(NamePart& part);
  void deeper(Grammar grammar, const Token& token);

  TokenStream& tokens_;
  int nesting_ = 0;
  int operations_ = 0;  // of the expression that is read
};

// The sign of formulas that other logics write so: "G" of "always", "&&" of "and"; "" of none.
std::string_view own_sign_of_formulas(std::string_view foreign);
Name to_name(const TokenStream& tokens, const Token& token);
// A decimal number. Throws ParseError: no number, or none of 63 bits.
std::int64_t parse_integer(const TokenStream& tokens, const Token& token);

}  // namespace maide::syntax
