// What an expression is worth, and what it does on the way: in order, with the short circuit of
// && and ||.
#pragma once

#include <string>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class ExpressionWalker {
 public:
  explicit ExpressionWalker(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  Value evaluate(const Expression& expression);
  // In order; a hole where several of them do something, for C++ leaves their order open.
  std::vector<Value> evaluate_all(const std::vector<Expression>& expressions, const Place& place,
                                  std::size_t first = 0);
  // Constants in the variable that this names are none any more.
  void forget(const Expression& expression);
  // What the expression is an element or part of.
  void forget_whole(const Expression& expression);
  // Something else may change it from here on.
  void share(const Expression& expression);
  // The variable that this names, if it does, has this value.
  void set_constant(const Expression& expression, const Value& value);
  // A method of the class by its name alone, as in `&A::tick`.
  Value callable(int function) const;
  // The value as a condition: of a pointer that is set it is `true`.
  static std::string truth(const Value& value);

 private:
  Value name(const Expression& expression);
  const ApiRow* find_row(const std::string& text) const;
  Value function_of_name(const Expression& expression);
  Value member(const Expression& expression);
  Slot slot(const Expression& expression);
  Value assign(const Expression& expression);
  Value logical(const Expression& expression);
  std::string sure_condition(const Value& value, const Place& place);
  Value conditional(const Expression& expression);
  Value literal(const Expression& expression) const;
  Value operation(const Expression& expression);
  Value unary(const Expression& expression, const Value& first);
  Value comparison(const Expression& expression, const std::vector<Value>& operands) const;
  Value arithmetic(const Expression& expression, const std::vector<Value>& operands);
  Value lambda(const Expression& expression);

  Walk& walk_;
  CodeWriter& writer_;
};

}  // namespace maide::extract
