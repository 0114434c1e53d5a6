// Recursive descent over expressions, with the operators and precedences of C++. Kinds are checked
// here: `+ - * / % < <= > >=` take numbers, `! && ||` booleans, `==` and `!=` two of one kind.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/language/expression.hpp"
#include "maide/check/language/system_names.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {

// The operators of expressions for a TokenStream, longest first.
inline constexpr std::string_view expression_symbols[] = {
    "==", "!=", "<=", ">=", "&&", "||", "..", "<", ">", "+", "-",
    "*",  "/",  "%",  "!",  "(",  ")",  "[",  "]", ",", "=", ":"};

Expression make_constant(Value value, ValueKind kind);
// Throws ParseError at the place of an operand that is of another kind than the operator takes.
// What is known at once is calculated.
Expression make_unary(Expression::Operator op, Expression operand, const SourcePosition& place);
Expression make_binary(Expression::Operator op, Expression left, Expression right,
                       const SourcePosition& place);
// Throws ParseError unless the expression is of that kind. `what`: "a condition".
void require(const Expression& expression, ValueKind kind, std::string_view what,
             const SourcePosition& place);
// A decimal number. Throws ParseError: no number, or none of 63 bits.
Value parse_integer(const TokenStream& tokens, const Token& token);

class ExpressionParser {
 public:
  // What a name stands for; of an array without its indices. Throws ParseError if it is not known.
  using Resolve = std::function<Expression(const Token& name)>;
  ExpressionParser(TokenStream& tokens, Resolve resolve)
      : tokens_(tokens), resolve_(std::move(resolve)) {}

  Expression parse();      // all operators
  Expression parse_sum();  // `+ - * / %` alone: a bound, an index
  // A number that is known at once. `what`: "a bound".
  Value parse_constant(std::string_view what);
  // LOW..HIGH, known at once, LOW at most HIGH unless `may_be_empty`.
  Expression::Dimension parse_range(std::string_view what, bool may_be_empty = false);
  // The indices behind a name, if it is an array's.
  std::vector<Expression> parse_indices(const Dimensions& dimensions, const Token& name);

 private:
  Expression parse_conjunction();
  Expression parse_equality();
  Expression parse_order();
  Expression parse_product();
  Expression parse_unary();
  Expression parse_primary();

  TokenStream& tokens_;
  Resolve resolve_;
  int nesting_ = 0;
};

}  // namespace maide
