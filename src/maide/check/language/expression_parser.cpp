#include "maide/check/language/expression_parser.hpp"

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/language/system_names.hpp"

namespace maide {

using Operator = Expression::Operator;

Expression make_constant(Value value, ValueKind kind) {
  Expression constant;
  constant.value = value;
  constant.kind = kind;
  return constant;
}

void require(const Expression& expression, ValueKind kind, std::string_view what,
             const SourcePosition& place) {
  if (expression.kind == kind) return;
  throw ParseError(
      std::string(what) + " is " + to_string(kind) + ", and this is " + to_string(expression.kind),
      place);
}

namespace {

// What the operator takes; `==` and `!=` take any kind.
ValueKind operand_kind(Operator op, const Expression& left) {
  if (op == Operator::equal || op == Operator::unequal) return left.kind;
  const bool is_logical =
      op == Operator::negation || op == Operator::conjunction || op == Operator::disjunction;
  return is_logical ? ValueKind::boolean : ValueKind::integer;
}

ValueKind result_kind(Operator op) {
  switch (op) {
    case Operator::negate:
    case Operator::times:
    case Operator::divide:
    case Operator::remainder:
    case Operator::plus:
    case Operator::minus: return ValueKind::integer;
    default: return ValueKind::boolean;
  }
}

Expression fold(Expression made) {
  for (const Expression& operand : made.operands) {
    if (!operand.is_constant()) return made;
  }
  try {
    const Value value = evaluate(made, [](const Expression&, std::uint32_t) { return Value{0}; });
    Expression constant = make_constant(value, made.kind);
    constant.line = made.line;
    constant.column = made.column;
    return constant;
  } catch (const EvaluationError&) {
    return made;  // it errs when control comes there, if it does
  }
}

}  // namespace

Expression make_unary(Operator op, Expression operand, const SourcePosition& place) {
  require(operand, operand_kind(op, operand),
          "what stands behind '" + std::string(symbol_of(op)) + "'", place);
  Expression made;
  made.op = op;
  made.kind = result_kind(op);
  made.line = place.line;
  made.column = place.column;
  made.operands.push_back(std::move(operand));
  return fold(std::move(made));
}

Expression make_binary(Operator op, Expression left, Expression right,
                       const SourcePosition& place) {
  const std::string symbol = "'" + std::string(symbol_of(op)) + "'";
  const ValueKind kind = operand_kind(op, left);
  require(left, kind, "what stands before " + symbol, place);
  require(right, kind, "what stands behind " + symbol, place);
  Expression made;
  made.op = op;
  made.kind = result_kind(op);
  made.line = place.line;
  made.column = place.column;
  made.operands.push_back(std::move(left));
  made.operands.push_back(std::move(right));
  return fold(std::move(made));
}

Value parse_integer(const TokenStream& tokens, const Token& token) {
  Value value = 0;
  const char* end = token.text.data() + token.text.size();
  const auto [stop, error] = std::from_chars(token.text.data(), end, value);
  if (token.kind == Token::Kind::number && error == std::errc::result_out_of_range) {
    tokens.fail("this number does not fit into 64 bits", token);
  }
  if (token.kind != Token::Kind::number || error != std::errc() || stop != end) {
    tokens.fail("expected a number, not " + to_string(token), token);
  }
  return value;
}

namespace {
constexpr int max_nesting = 200;  // of an expression: the parser recurses
}

Expression ExpressionParser::parse() {
  Expression left = parse_conjunction();
  while (tokens_.peek().is("||")) {
    const SourcePosition place = tokens_.position(tokens_.next());
    left = make_binary(Operator::disjunction, std::move(left), parse_conjunction(), place);
  }
  return left;
}

Expression ExpressionParser::parse_conjunction() {
  Expression left = parse_equality();
  while (tokens_.peek().is("&&")) {
    const SourcePosition place = tokens_.position(tokens_.next());
    left = make_binary(Operator::conjunction, std::move(left), parse_equality(), place);
  }
  return left;
}

Expression ExpressionParser::parse_equality() {
  Expression left = parse_order();
  while (tokens_.peek().is("==") || tokens_.peek().is("!=")) {
    const Token sign = tokens_.next();
    left = make_binary(sign.is("==") ? Operator::equal : Operator::unequal, std::move(left),
                       parse_order(), tokens_.position(sign));
  }
  return left;
}

Expression ExpressionParser::parse_order() {
  Expression left = parse_sum();
  for (;;) {
    const Token sign = tokens_.peek();
    const Operator op = sign.is("<")    ? Operator::less
                        : sign.is("<=") ? Operator::at_most
                        : sign.is(">")  ? Operator::greater
                        : sign.is(">=") ? Operator::at_least
                                        : Operator::constant;
    if (op == Operator::constant) return left;
    tokens_.next();
    left = make_binary(op, std::move(left), parse_sum(), tokens_.position(sign));
  }
}

Expression ExpressionParser::parse_sum() {
  Expression left = parse_product();
  while (tokens_.peek().is("+") || tokens_.peek().is("-")) {
    const Token sign = tokens_.next();
    left = make_binary(sign.is("+") ? Operator::plus : Operator::minus, std::move(left),
                       parse_product(), tokens_.position(sign));
  }
  return left;
}

Expression ExpressionParser::parse_product() {
  Expression left = parse_unary();
  for (;;) {
    const Token sign = tokens_.peek();
    const Operator op = sign.is("*")   ? Operator::times
                        : sign.is("/") ? Operator::divide
                        : sign.is("%") ? Operator::remainder
                                       : Operator::constant;
    if (op == Operator::constant) return left;
    tokens_.next();
    left = make_binary(op, std::move(left), parse_unary(), tokens_.position(sign));
  }
}

Expression ExpressionParser::parse_unary() {
  const Token first = tokens_.peek();
  if (!first.is("-") && !first.is("!")) return parse_primary();
  if (++nesting_ > max_nesting) tokens_.fail("this expression is nested too deeply", first);
  tokens_.next();
  Expression made = make_unary(first.is("-") ? Operator::negate : Operator::negation, parse_unary(),
                               tokens_.position(first));
  --nesting_;
  return made;
}

Expression ExpressionParser::parse_primary() {
  const Token first = tokens_.next();
  if (first.is("(")) {
    if (++nesting_ > max_nesting) tokens_.fail("this expression is nested too deeply", first);
    Expression inner = parse();
    tokens_.expect(")", "at the end of what '(' begins");
    --nesting_;
    return inner;
  }
  const SourcePosition place = tokens_.position(first);
  if (first.kind == Token::Kind::number) {
    if (tokens_.peek().is(".") && tokens_.peek(1).kind == Token::Kind::number) {
      tokens_.fail("numbers are whole, without a fraction", first);
    }
    return make_constant(parse_integer(tokens_, first), ValueKind::integer);
  }
  if (first.is("true") || first.is("false")) {
    return make_constant(first.is("true") ? 1 : 0, ValueKind::boolean);
  }
  if (!first.is_name()) tokens_.fail("expected an expression, not " + to_string(first), first);
  if (first.is("not") && (tokens_.peek().is_name() || tokens_.peek().is("("))) {
    tokens_.fail_foreign(first);
  }
  Expression named = resolve_(first);
  named.line = place.line;
  named.column = place.column;
  if (named.operands.empty()) named.operands = parse_indices(named.dimensions, first);
  return named;
}

std::vector<Expression> ExpressionParser::parse_indices(const Dimensions& dimensions,
                                                        const Token& name) {
  std::vector<Expression> indices;
  if (dimensions.empty()) {
    if (tokens_.peek().is("[")) {
      tokens_.fail("'" + name.text + "' is no array", tokens_.peek());
    }
    return indices;
  }
  if (!tokens_.peek().is("[")) {
    tokens_.fail("'" + name.text + "' is an array: say which member, as in " + name.text +
                     member_suffix(dimensions, 0),
                 name);
  }
  tokens_.next();
  do {
    const SourcePosition place = tokens_.position(tokens_.peek());
    indices.push_back(parse_sum());
    require(indices.back(), ValueKind::integer, "an index", place);
  } while (tokens_.accept(","));
  if (indices.size() != dimensions.size()) {
    tokens_.fail("'" + name.text + "' has " + std::to_string(dimensions.size()) +
                     (dimensions.size() == 1 ? " index" : " indices") + ", not " +
                     std::to_string(indices.size()),
                 name);
  }
  tokens_.expect("]", "behind an index");
  return indices;
}

Value ExpressionParser::parse_constant(std::string_view what) {
  const Token first = tokens_.peek();
  const Expression value = parse_sum();
  require(value, ValueKind::integer, what, tokens_.position(first));
  if (!value.is_constant()) {
    tokens_.fail(std::string(what) + " is made of numbers, constants and indices of arrays alone",
                 first);
  }
  return value.value;
}

Expression::Dimension ExpressionParser::parse_range(std::string_view what, bool may_be_empty) {
  const Token first = tokens_.peek();
  Expression::Dimension range;
  range.low = parse_constant(what);
  tokens_.expect("..", "between the least and the greatest");
  range.high = parse_constant(what);
  if (range.low > range.high && !may_be_empty) {
    tokens_.fail(std::string(what) + " goes from the least to the greatest, and " +
                     std::to_string(range.low) + " is greater than " + std::to_string(range.high),
                 first);
  }
  constexpr Value far = Value{1} << 62;
  if (range.low < -far || range.high > far) tokens_.fail("bounds go up to 2^62", first);
  return range;
}

}  // namespace maide
