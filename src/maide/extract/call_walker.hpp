// Calls: each is inlined, a row of a table, or a hole.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class CallWalker {
 public:
  using Arguments = std::vector<Value>;
  explicit CallWalker(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  Value call(const Expression& expression);
  Value call_value(const Value& callee, const Arguments& arguments, const Place& place);
  Value inline_function(int function, const Value& self, const Arguments& arguments,
                        const std::shared_ptr<Frame>& outer, const Place& place);
  // Gives the parameters of a function their values, as its body sees them: arguments, as their
  // types have them, and defaults.
  Arguments bind_parameters(const Function& function, Arguments arguments, const Place& place);
  // Constants in variables that were handed on are none any more.
  void forget_arguments(const Expression& call);

  // How many functions are inside each other here.
  std::size_t depth() const { return stack_.size(); }

 private:
  Value call_name(const Expression& expression, const Expression& callee);
  Value call_method(const Expression& expression, const Expression& callee);
  Value call_method_of(const Expression& expression, const Expression& callee, const Value& self,
                       const Class& entry, bool& is_done);
  Value call_free(const Expression& expression, const Expression& callee);
  Value call_smart_pointer(const Expression& expression, const Expression& callee,
                           const Value& self);
  Value call_what_is_kept(const Expression& expression, const Expression& callee);
  bool is_another_while_made(const Value& self, const Overloads& found) const;
  bool is_of_smart_pointer(const Expression& callee, const Value& self) const;
  Value apply_row(const ApiRow& row, const Expression& expression, const Value& self);
  Value inline_one_of(const Overloads& overloads, const Value& self, const Expression& call);
  Value inline_any(const std::vector<int>& functions, std::size_t first, const Value& self,
                   const Arguments& arguments, const Place& place);
  Value result_of(const Frame& frame) const;
  Arguments arguments_of(const Expression& call);
  Value unknown_call(const Expression& expression, const std::string& name, const Value& self);

  Walk& walk_;
  CodeWriter& writer_;
  std::vector<int> stack_;
};

}  // namespace maide::extract
