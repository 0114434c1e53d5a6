#include "maide/check/language/expression.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/check/language/code.hpp"

namespace maide {

std::string to_string(ValueKind kind) {
  switch (kind) {
    case ValueKind::integer: return "a number";
    case ValueKind::boolean: return "true or false";
    case ValueKind::word: return "a word";
    case ValueKind::unknown: return "not known yet";
  }
  return "";
}

Value WordTable::intern(const std::string& word) {
  const auto place = std::ranges::find(words_, word);
  const auto number = static_cast<Value>(place - words_.begin());
  if (place == words_.end()) words_.push_back(word);
  return number;
}

std::optional<Value> WordTable::find(const std::string& word) const {
  const auto place = std::ranges::find(words_, word);
  if (place == words_.end()) return std::nullopt;
  return static_cast<Value>(place - words_.begin());
}

std::uint64_t ValueType::count() const {
  if (kind == ValueKind::word) return words.size();
  return distance(low, high) + 1;
}

bool ValueType::contains(Value value) const {
  if (kind == ValueKind::word) return std::ranges::find(words, value) != words.end();
  return low <= value && value <= high;
}

std::uint64_t ValueType::place_of(Value value) const {
  MAIDE_CHECK(contains(value));
  if (kind == ValueKind::word) {
    return static_cast<std::uint64_t>(std::ranges::find(words, value) - words.begin());
  }
  return distance(low, value);
}

Value ValueType::at(std::uint64_t place) const {
  if (kind == ValueKind::word) return words[place];
  return static_cast<Value>(static_cast<std::uint64_t>(low) + place);
}

std::string to_string(Value value, ValueKind kind, const WordTable& words) {
  switch (kind) {
    case ValueKind::integer: return std::to_string(value);
    case ValueKind::boolean: return value != 0 ? "true" : "false";
    case ValueKind::word: return words.name(value);
    case ValueKind::unknown: break;
  }
  return "";
}

std::string to_string(const ValueType& type, const WordTable& words) {
  if (type.kind == ValueKind::boolean) return "bool";
  if (type.kind == ValueKind::integer) {
    return std::to_string(type.low) + ".." + std::to_string(type.high);
  }
  std::string text;
  for (const Value word : type.words) text += (text.empty() ? "" : ", ") + words.name(word);
  return "{" + text + "}";
}

std::string_view symbol_of(Expression::Operator op) {
  using Operator = Expression::Operator;
  switch (op) {
    case Operator::negate: return "-";
    case Operator::negation: return "!";
    case Operator::times: return "*";
    case Operator::divide: return "/";
    case Operator::remainder: return "%";
    case Operator::plus: return "+";
    case Operator::minus: return "-";
    case Operator::less: return "<";
    case Operator::at_most: return "<=";
    case Operator::greater: return ">";
    case Operator::at_least: return ">=";
    case Operator::equal: return "==";
    case Operator::unequal: return "!=";
    case Operator::conjunction: return "&&";
    case Operator::disjunction: return "||";
    default: return "";
  }
}

std::string to_string(const Expression& expression, const WordTable& words) {
  using Operator = Expression::Operator;
  const auto operand = [&](std::size_t i) {
    const Expression& inner = expression.operands[i];
    const std::string text = to_string(inner, words);
    const bool is_leaf = symbol_of(inner.op).empty();
    return is_leaf ? text : "(" + text + ")";
  };
  if (expression.op == Operator::constant) {
    return to_string(expression.value, expression.kind, words);
  }
  if (expression.op == Operator::local || expression.op == Operator::shared) {
    std::string indices;
    for (const Expression& index : expression.operands) {
      indices += (indices.empty() ? "[" : ", ") + to_string(index, words);
    }
    return expression.name + (indices.empty() ? "" : indices + "]");
  }
  const std::string symbol(symbol_of(expression.op));
  if (expression.operands.size() == 1) return symbol + operand(0);
  return operand(0) + " " + symbol + " " + operand(1);
}

void for_each_variable(const Expression& expression,
                       const std::function<void(const Expression&)>& visit) {
  using Operator = Expression::Operator;
  if (expression.op == Operator::local || expression.op == Operator::shared) visit(expression);
  for (const Expression& operand : expression.operands) for_each_variable(operand, visit);
}

bool reads_shared(const Expression& expression) {
  if (expression.op == Expression::Operator::shared) return true;
  return std::ranges::any_of(expression.operands, reads_shared);
}

std::uint32_t element_count(const Expression& variable) {
  std::uint32_t count = 1;
  for (const Expression::Dimension& range : variable.dimensions) {
    count *= static_cast<std::uint32_t>(range.high - range.low + 1);
  }
  return count;
}

std::uint32_t element_of(const Expression& where, const std::vector<Value>& indices) {
  std::uint64_t element = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const Expression::Dimension& range = where.dimensions[i];
    if (indices[i] < range.low || indices[i] > range.high) {
      throw EvaluationError{where.name + "[" + std::to_string(indices[i]) + "] is outside of " +
                                std::to_string(range.low) + ".." + std::to_string(range.high),
                            where.line, where.column};
    }
    element = element * static_cast<std::uint64_t>(range.high - range.low + 1) +
              static_cast<std::uint64_t>(indices[i] - range.low);
  }
  return static_cast<std::uint32_t>(element);
}

namespace {

Value calculate(const Expression& expression, Value left, Value right) {
  const auto fail = [&](const std::string& text) {
    return EvaluationError{text, expression.line, expression.column};
  };
  Value result = 0;
  bool overflows = false;
  switch (expression.op) {
    case Expression::Operator::plus:
      overflows = __builtin_add_overflow(left, right, &result);
      break;
    case Expression::Operator::minus:
      overflows = __builtin_sub_overflow(left, right, &result);
      break;
    case Expression::Operator::times:
      overflows = __builtin_mul_overflow(left, right, &result);
      break;
    default: {
      if (right == 0) throw fail("division by zero");
      overflows = right == -1 && __builtin_sub_overflow(Value{0}, left, &result);
      if (overflows) break;
      if (right == -1) {
        result = expression.op == Expression::Operator::divide ? result : 0;
      } else {
        result = expression.op == Expression::Operator::divide ? left / right : left % right;
      }
    }
  }
  if (overflows) throw fail("a result that 64 bits do not hold");
  return result;
}

}  // namespace

Value evaluate(const Expression& expression, const Lookup& value_of) {
  const auto operand = [&](std::size_t i) { return evaluate(expression.operands[i], value_of); };
  switch (expression.op) {
    case Expression::Operator::constant: return expression.value;
    case Expression::Operator::local:
    case Expression::Operator::shared: {
      std::vector<Value> indices;
      for (std::size_t i = 0; i < expression.operands.size(); ++i) indices.push_back(operand(i));
      return value_of(expression, expression.index + element_of(expression, indices));
    }
    case Expression::Operator::negate: {
      Expression zero = expression;
      zero.op = Expression::Operator::minus;
      return calculate(zero, 0, operand(0));
    }
    case Expression::Operator::negation: return operand(0) == 0 ? 1 : 0;
    case Expression::Operator::conjunction: return operand(0) != 0 && operand(1) != 0 ? 1 : 0;
    case Expression::Operator::disjunction: return operand(0) != 0 || operand(1) != 0 ? 1 : 0;
    default: break;
  }
  const Value left = operand(0), right = operand(1);
  switch (expression.op) {
    case Expression::Operator::less: return left < right ? 1 : 0;
    case Expression::Operator::at_most: return left <= right ? 1 : 0;
    case Expression::Operator::greater: return left > right ? 1 : 0;
    case Expression::Operator::at_least: return left >= right ? 1 : 0;
    case Expression::Operator::equal: return left == right ? 1 : 0;
    case Expression::Operator::unequal: return left != right ? 1 : 0;
    default: return calculate(expression, left, right);
  }
}

// ---- Making expressions -------------------------------------------------------------------------

std::optional<Expression::Operator> operator_of(syntax::Sign sign) {
  using enum Expression::Operator;
  using syntax::Sign;
  switch (sign) {
    case Sign::negate: return negate;
    case Sign::negation: return negation;
    case Sign::times: return times;
    case Sign::divide: return divide;
    case Sign::remainder: return remainder;
    case Sign::plus: return plus;
    case Sign::minus: return minus;
    case Sign::less: return less;
    case Sign::at_most: return at_most;
    case Sign::greater: return greater;
    case Sign::at_least: return at_least;
    case Sign::equal: return equal;
    case Sign::unequal: return unequal;
    case Sign::conjunction: return conjunction;
    case Sign::disjunction: return disjunction;
    default: return std::nullopt;
  }
}

Expression make_constant(Value value, ValueKind kind) {
  Expression constant;
  constant.value = value;
  constant.kind = kind;
  return constant;
}

void require(const Expression& expression, ValueKind kind, std::string_view what,
             const SourcePosition& place) {
  if (expression.kind == kind) return;
  if (expression.kind == ValueKind::unknown || kind == ValueKind::unknown) return;
  throw ParseError(
      std::string(what) + " is " + to_string(kind) + ", and this is " + to_string(expression.kind),
      place);
}

namespace {

// What the operator takes; `==` and `!=` take any kind.
ValueKind operand_kind(Expression::Operator op, const Expression& left) {
  if (op == Expression::Operator::equal || op == Expression::Operator::unequal) return left.kind;
  const bool is_logical = op == Expression::Operator::negation ||
                          op == Expression::Operator::conjunction ||
                          op == Expression::Operator::disjunction;
  return is_logical ? ValueKind::boolean : ValueKind::integer;
}

ValueKind result_kind(Expression::Operator op) {
  switch (op) {
    case Expression::Operator::negate:
    case Expression::Operator::times:
    case Expression::Operator::divide:
    case Expression::Operator::remainder:
    case Expression::Operator::plus:
    case Expression::Operator::minus: return ValueKind::integer;
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

Expression make_unary(Expression::Operator op, Expression operand, const SourcePosition& place) {
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

Expression make_binary(Expression::Operator op, Expression left, Expression right,
                       const SourcePosition& place) {
  const std::string symbol = "'" + std::string(symbol_of(op)) + "'";
  ValueKind kind = operand_kind(op, left);
  if (kind == ValueKind::unknown) kind = right.kind;
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

}  // namespace maide
