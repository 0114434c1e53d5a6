// Expressions over variables, as programs and formulas have them: integers of 64 bits, booleans and
// words, with the operators of C++. Names are resolved before: a leaf is a constant, a variable of
// a program, or a shared variable, which is a model instance of its own. Kinds are checked when
// an expression is made; what depends on values is found by evaluating.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {
namespace syntax {
enum class Sign : std::uint8_t;
}

// An integer; 0 or 1; or the number of a word (WordTable).
using Value = std::int64_t;

// high - low, which 63 bits need not hold. `low` is at most `high`.
constexpr std::uint64_t distance(Value low, Value high) {
  return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
}

enum class ValueKind : std::uint8_t {
  integer,
  boolean,
  word,
  unknown,  // it comes from a model whose outputs are not known yet; it may stand anywhere
};
std::string to_string(ValueKind kind);  // "a number", "true or false", "a word"

// The words of a system file, each with a number: the same wherever it is spelled alike.
class WordTable {
 public:
  Value intern(const std::string& word);
  std::optional<Value> find(const std::string& word) const;
  const std::string& name(Value word) const { return words_[static_cast<std::size_t>(word)]; }
  const std::vector<std::string>& names() const { return words_; }  // by number

 private:
  std::vector<std::string> words_;
};

// What a variable may hold.
struct ValueType {
  ValueKind kind = ValueKind::integer;
  Value low = 0, high = 0;   // of an integer; of a boolean 0 and 1
  std::vector<Value> words;  // of a word: in the order of the declaration

  // At least 1.
  std::uint64_t count() const;
  bool contains(Value value) const;
  // The place of a value that it contains, from 0; and back.
  std::uint64_t place_of(Value value) const;
  Value at(std::uint64_t place) const;
  bool operator==(const ValueType&) const = default;
};

// "3", "true", "busy".
std::string to_string(Value value, ValueKind kind, const WordTable& words);
// "0..3", "bool", "{idle, busy}".
std::string to_string(const ValueType& type, const WordTable& words);

struct Expression {
  enum class Operator : std::uint8_t {
    constant,
    local,   // variable number `index` of program `owner`
    shared,  // the shared variable that is model instance number `index`
    negate,
    negation,  // !
    times,
    divide,
    remainder,
    plus,
    minus,
    less,
    at_most,
    greater,
    at_least,
    equal,
    unequal,
    conjunction,
    disjunction,
  };
  Operator op = Operator::constant;
  ValueKind kind = ValueKind::integer;  // of its value
  Value value = 0;                      // of a constant
  std::uint32_t owner = 0, index = 0;   // of a variable; of an array the first element's
  // Of an array: one index for each dimension, in `operands`. Elements lie side by side, the last
  // index running fastest.
  struct Dimension {
    Value low = 0, high = 0;
    bool operator==(const Dimension&) const = default;
  };
  std::vector<Dimension> dimensions;
  std::vector<Expression> operands;
  std::string name;  // of a variable, for messages
  int line = 0, column = 0;

  bool is_constant() const { return op == Operator::constant; }
};

// "+"; "" of a constant or a variable.
std::string_view symbol_of(Expression::Operator op);
// In the words of the language, with brackets around each operation but the outermost.
std::string to_string(const Expression& expression, const WordTable& words);

// Calls `visit(leaf)` for each variable in the expression, arrays included.
void for_each_variable(const Expression& expression,
                       const std::function<void(const Expression&)>& visit);
bool reads_shared(const Expression& expression);
// Of a variable: the elements of the array that it is; 1 for one that is none.
std::uint32_t element_count(const Expression& variable);

// What stops an evaluation.
struct EvaluationError {
  std::string text;  // "division by zero"
  int line = 0, column = 0;
};

// The number of the element that the indices name, from the array's first one. `where`: the
// expression, for its dimensions and its place. Throws EvaluationError.
std::uint32_t element_of(const Expression& where, const std::vector<Value>& indices);

// The value. `value_of(leaf, number)` is asked for each variable that is met: its index, that of
// the element of an array. `&&` and `||` do not evaluate their right side if the left one decides.
// Throws EvaluationError: division by zero, an index outside its array, a result that 64 bits do
// not hold; and whatever `value_of` throws.
using Lookup = std::function<Value(const Expression& leaf, std::uint32_t index)>;
Value evaluate(const Expression& expression, const Lookup& value_of);

// ---- Making expressions ----
//
// `+ - * / % < <= > >=` take numbers, `! && ||` booleans, `==` and `!=` two of one kind.

// The operator of expressions that a sign is; none of a sign of formulas.
std::optional<Expression::Operator> operator_of(syntax::Sign sign);
Expression make_constant(Value value, ValueKind kind);
// Throws ParseError at the place of an operand that is of another kind than the operator takes.
// What is known at once is calculated.
Expression make_unary(Expression::Operator op, Expression operand, const SourcePosition& place);
Expression make_binary(Expression::Operator op, Expression left, Expression right,
                       const SourcePosition& place);
// Throws ParseError unless the expression is of that kind. `what`: "a condition".
void require(const Expression& expression, ValueKind kind, std::string_view what,
             const SourcePosition& place);

}  // namespace maide
