// Goes through statements, and writes what they do in the language of programs.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class StatementWalker {
 public:
  explicit StatementWalker(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  void walk(const std::vector<Statement>& list);
  // A function's body: no loop around the call is its own.
  void walk_body(const std::vector<Statement>& list);

 private:
  void one(const Statement& next);
  void declare(const Statement& next);
  void declare_static(const Statement& next, const Variable& variable);
  void branch(const Statement& next);
  void loop(const Statement& next);
  void loop_variable(const Statement& next);
  Value leave_unless(const Expression& condition, const Place& place);
  void write_body(const Statement& next, const std::string& again,
                  const std::set<std::string>& before);
  void finish_loop(const Statement& next, Code code, const Value& condition, bool raises,
                   bool is_finite);
  void choice(const Statement& next);
  void attempt(const Statement& next);
  void may_throw(const Statement& next);
  void block(const Statement& next);
  void returns(const Statement& next);
  void jump(const Statement& next);

  Walk& walk_;
  CodeWriter& writer_;
  std::vector<std::pair<std::string, std::string>> loops_;  // break, continue
};

}  // namespace maide::extract
