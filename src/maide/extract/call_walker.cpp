#include "maide/extract/call_walker.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/expression_walker.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/row_reader.hpp"
#include "maide/extract/statement_walker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

using Form = Expression::Kind;
constexpr std::size_t deepest_inlining = 40;

}  // namespace

Value CallWalker::call(const Expression& expression) {
  const Expression& callee = expression.operands[0];
  if (callee.kind == Form::member) return call_method(expression, callee);
  if (callee.kind == Form::name) return call_name(expression, callee);
  return call_what_is_kept(expression, callee);
}

Value CallWalker::call_what_is_kept(const Expression& expression, const Expression& callee) {
  const Value value = walk_.expressions->evaluate(callee);
  const Arguments arguments = arguments_of(expression);
  Value result = call_value(value, arguments, expression.place);
  forget_arguments(expression);
  return result;
}

CallWalker::Arguments CallWalker::arguments_of(const Expression& call) {
  return walk_.expressions->evaluate_all(call.operands, call.place, 1);
}

void CallWalker::forget_arguments(const Expression& call) {
  for (std::size_t i = 1; i < call.operands.size(); ++i) {
    walk_.expressions->forget(call.operands[i]);
  }
}

Value CallWalker::unknown_call(const Expression& expression, const std::string& name,
                               const Value& self) {
  Arguments all = arguments_of(expression);
  all.push_back(self);
  writer_.hole(expression.place, "a call of " + name, any_matters(all));
  forget_arguments(expression);
  return unknown_value();
}

// ---- By name ----

Value CallWalker::call_name(const Expression& expression, const Expression& callee) {
  if (callee.variable != none) {
    return call_what_is_kept(expression, callee);
  }
  const Value self = walk_.values.frame().self;
  const std::string of_class =
      self.kind == Value::Kind::object ? walk_.object(self.index).of_class : self.type;
  const bool is_bare = callee.text.find("::") == std::string::npos;
  const Class* own = is_bare ? walk_.names.find_class(of_class, "") : nullptr;
  if (own != nullptr) {
    bool is_done = false;
    Value value = call_method_of(expression, callee, self, *own, is_done);
    if (is_done) return value;
  }
  if (self.kind == Value::Kind::object && !is_bare) {  // Base::tick(): that of the base
    const Class* base = walk_.names.find_class(outer_part(callee.text), walk_.values.frame().scope);
    const bool is_own = base != nullptr &&
                        (base->name == of_class || walk_.names.derives_from(of_class, base->name));
    const std::size_t count = expression.operands.size() - 1;
    if (is_own) {
      const Overloads found = walk_.names.methods(*base, last_part(callee.text), count);
      if (!found.bodies.empty()) return inline_one_of(found, self, expression);
    }
  }
  return call_free(expression, callee);
}

Value CallWalker::call_free(const Expression& expression, const Expression& callee) {
  if (const ApiRow* row = walk_.table.find_function(callee.text)) {
    return apply_row(*row, expression, {});
  }
  const std::string& scope = walk_.values.frame().scope;
  const Class* entry = walk_.names.find_class(callee.text, scope);
  if (entry != nullptr || is_plain_type(callee.text) || walk_.table.has_class(callee.text) ||
      is_message_type(callee.text)) {
    const std::string type =
        callee.type.empty() ? callee.text : callee.text + "<" + callee.type + ">";
    walk_.objects->share_arguments(type, expression.operands, 1);
    return walk_.objects->construct(type, arguments_of(expression), expression.place, "");
  }
  const std::size_t count = expression.operands.size() - 1;
  const Overloads found = walk_.names.free_functions(callee.text, scope, count);
  if (!found.bodies.empty()) return inline_one_of(found, {}, expression);
  return unknown_call(expression, callee.text, {});
}

// ---- Methods ----

Value CallWalker::apply_row(const ApiRow& row, const Expression& expression, const Value& self) {
  const std::size_t written = writer_.written();
  Value value = walk_.rows->apply(row, expression, self);
  if (writer_.written() != written) ++walk_.acting_calls;
  return value;
}

Value CallWalker::call_method_of(const Expression& expression, const Expression& callee,
                                 const Value& self, const Class& entry, bool& is_done) {
  const std::size_t count = expression.operands.size() - 1;
  const Overloads found = walk_.names.methods(entry, callee.text, count);
  const bool is_exact = self.kind == Value::Kind::object;
  const bool is_virtual = std::ranges::any_of(
      found.bodies, [&](int method) { return walk_.function(method).is_virtual; });
  is_done = true;
  if (!found.bodies.empty() || found.may_be_elsewhere) {
    if (found.bodies.empty() || (is_virtual && !is_exact)) {
      return unknown_call(expression, entry.name + "::" + callee.text, self);
    }
    if (is_exact && is_another_while_made(self, found)) {
      writer_.hole(expression.place, "a method of a class that is being made: " + callee.text,
                   true);
    }
    return inline_one_of(found, self, expression);
  }
  const std::string base = walk_.names.api_base(entry.name);
  const ApiRow* row = walk_.table.find_method(base, callee.text);
  if (row != nullptr && !walk_.names.has_unknown_base(entry)) {
    return apply_row(*row, expression, self);
  }
  is_done = callee.kind == Form::member || walk_.names.has_unknown_base(entry);
  if (!is_done) return {};
  return unknown_call(expression, entry.name + "::" + callee.text, self);
}

// In a constructor of a base the methods of the derived class are not there yet.
bool CallWalker::is_another_while_made(const Value& self, const Overloads& found) const {
  const Object& object = walk_.object(self.index);
  if (object.being_made.empty() || object.being_made == object.of_class) return false;
  return std::ranges::any_of(found.bodies, [&](int method) {
    const std::string& of_class = walk_.function(method).of_class;
    return of_class != object.being_made && !walk_.names.derives_from(object.being_made, of_class);
  });
}

// `x.reset()` of a pointer lets the end go; `x->reset()` is the end's own.
bool CallWalker::is_of_smart_pointer(const Expression& callee, const Value& self) const {
  static const std::set<std::string> own{"reset",  "swap",    "release",   "get",         "lock",
                                         "unique", "expired", "use_count", "owner_before"};
  if (callee.is_arrow || !own.contains(callee.text)) return false;
  const Expression& of = callee.operands[0];
  if (of.kind == Form::other && of.text == "*") return false;
  const bool has_pointer_type =
      of.variable != none && is_pointer_type(walk_.variable(of.variable).type);
  const bool is_lock = self.type == "std::unique_lock" || self.type == "std::mutex" ||
                       self.type == "std::recursive_mutex";
  return has_pointer_type || (self.kind == Value::Kind::entity && !is_lock);
}

Value CallWalker::call_smart_pointer(const Expression& expression, const Expression& callee,
                                     const Value& self) {
  const Arguments arguments = arguments_of(expression);
  if (callee.text == "get" && arguments.empty()) return self;
  if (callee.text == "unique" || callee.text == "expired" || callee.text == "use_count") return {};
  Expression assignment;
  assignment.kind = Form::assign;
  assignment.text = "=";
  assignment.place = expression.place;
  assignment.operands = {callee.operands[0], Expression{}};
  if (self.matters() || any_matters(arguments)) {
    writer_.hole(expression.place, "an end goes, or another takes its place", true);
  }
  walk_.expressions->evaluate(assignment);
  return unknown_value();
}

Value CallWalker::call_method(const Expression& expression, const Expression& callee) {
  const Value self = walk_.expressions->evaluate(callee.operands[0]);
  if (callee.is_arrow && self.kind == Value::Kind::object && !self.is_pointer) {
    writer_.hole(expression.place, "'->' of an object", true);
  }
  if (is_of_smart_pointer(callee, self)) return call_smart_pointer(expression, callee, self);
  std::string type = self.type;
  if (self.kind == Value::Kind::object) type = walk_.object(self.index).of_class;
  if (const Class* entry = walk_.names.find_class(type, walk_.values.frame().scope)) {
    bool is_done = false;
    return call_method_of(expression, callee, self, *entry, is_done);
  }
  const ApiRow* row = is_message_type(type) ? walk_.table.find_method("message", callee.text)
                                            : walk_.table.find_method(type, callee.text);
  if (row != nullptr && (self.kind != Value::Kind::mixed || row->means == "inert")) {
    return apply_row(*row, expression, self);
  }
  const bool is_named = !type.empty() && type != "?";
  return unknown_call(expression, (is_named ? type + "::" : "") + callee.text, self);
}

// ---- Inlining ----

Value CallWalker::inline_one_of(const Overloads& overloads, const Value& self,
                                const Expression& call) {
  const Arguments arguments = arguments_of(call);
  if (overloads.may_be_elsewhere) {
    Arguments all = arguments;
    all.push_back(self);
    writer_.hole(call.place,
                 "a call that may mean a function that is elsewhere: " +
                     walk_.function(overloads.bodies.front()).full_name(),
                 any_matters(all));
  }
  Value value = inline_any(overloads.bodies, 0, self, arguments, call.place);
  for (const int function : overloads.bodies) {
    const Function& called = walk_.function(function);
    for (std::size_t i = 0; i + 1 < call.operands.size() && i < called.parameters.size(); ++i) {
      if (walk_.may_be_written(called, i)) walk_.expressions->forget(call.operands[i + 1]);
    }
  }
  return value;
}

// Overloads: any of them.
Value CallWalker::inline_any(const std::vector<int>& functions, std::size_t first,
                             const Value& self, const Arguments& arguments, const Place& place) {
  const auto one = [&] {
    const Function& function = walk_.function(functions[first]);
    const Value own = function.is_static ? Value{} : self;
    return inline_function(functions[first], own, arguments, nullptr, place);
  };
  if (first + 1 == functions.size()) return one();
  Value value, other;
  writer_.either(
      place, [&] { value = one(); },
      [&] { other = inline_any(functions, first + 1, self, arguments, place); });
  const bool matters = value.matters() || other.matters();
  value = data_value(value.type);
  if (matters) value.kind = Value::Kind::mixed;
  return value;
}

CallWalker::Arguments CallWalker::bind_parameters(const Function& function, Arguments arguments,
                                                  const Place& place) {
  const std::size_t given = arguments.size();
  arguments.resize(std::max(arguments.size(), function.parameters.size()));
  Arguments fitted;
  for (std::size_t i = 0; i < function.parameters.size(); ++i) {
    Value value = std::move(arguments[i]);
    if (i >= given && !function.defaults[i].empty()) {
      const std::size_t written = writer_.written();
      value = walk_.expressions->evaluate(function.defaults[i][0]);
      if (writer_.written() != written) {
        writer_.hole(place, "a default argument that communicates", false);
      }
    }
    value = walk_.objects->converted(function.parameter_types[i], std::move(value), place);
    fitted.push_back(value);
    const std::string type = class_of_type(function.parameter_types[i]);
    if (!value.matters() && (value.type.empty() || value.type == "?")) value.type = type;
    if (function.parameters[i] != none) {
      walk_.values.declare(function.parameters[i], std::move(value));
    }
  }
  return fitted;
}

Value CallWalker::inline_function(int index, const Value& self, const Arguments& arguments,
                                  const std::shared_ptr<Frame>& outer, const Place& place) {
  const Function& function = walk_.function(index);
  if (std::ranges::find(stack_, index) != stack_.end() || stack_.size() > deepest_inlining) {
    writer_.hole(place, "recursion: " + function.full_name(), false);
    return unknown_value();
  }
  if (!writer_.is_silent()) walk_.read.insert(index);
  stack_.push_back(index);
  const int acting = std::exchange(walk_.acting_calls, 0);
  const auto caller = walk_.values.enter(std::make_shared<Frame>());
  Frame& frame = walk_.values.frame();
  frame.self = self;
  frame.outer = outer;
  frame.scope = !function.of_class.empty() ? function.of_class : function.scope;
  if (outer != nullptr) frame.scope = outer->scope;
  frame.return_flag = writer_.fresh("r");
  frame.return_value = writer_.fresh("v");
  writer_.set(frame.return_flag, "false");
  bind_parameters(function, arguments, place);
  const std::set<std::string> raised = writer_.raised();
  walk_.statements->walk_body(function.body);
  const std::string& thrown = writer_.throw_flag();
  if (function.is_noexcept && writer_.raised().contains(thrown) && !raised.contains(thrown)) {
    writer_.hole(place, "a throw out of a function that is noexcept", true);
  }
  writer_.lower(frame.return_flag);
  Value result = result_of(frame);
  walk_.values.enter(caller);
  walk_.acting_calls = acting;
  stack_.pop_back();
  return result;
}

// What was returned on all ways; a truth value is known if each way has said it.
Value CallWalker::result_of(const Frame& frame) const {
  if (frame.returns.empty()) return {};
  const bool all_say = std::ranges::all_of(
      frame.returns, [](const Value& value) { return !value.condition.empty(); });
  if (frame.returns.size() == 1) {
    Value only = frame.returns[0];
    return only;
  }
  Value result = data_value(frame.returns[0].type);
  if (any_matters(frame.returns)) result.kind = Value::Kind::mixed;
  if (all_say && result.kind == Value::Kind::data) {
    result.condition = frame.return_value;
    result.program = writer_.program();
  }
  return result;
}

Value CallWalker::call_value(const Value& callee, const Arguments& arguments, const Place& place) {
  if (callee.kind != Value::Kind::callable || callee.callable->function == none) {
    Arguments all = arguments;
    all.push_back(callee);
    writer_.hole(place, "a call of what is not known", any_matters(all));
    return unknown_value();
  }
  const Callable& callable = *callee.callable;
  const Function& function = walk_.function(callable.function);
  Arguments all;
  if (callable.is_bound) {
    for (const BoundArgument& bound : callable.bound) {
      const auto place_of = static_cast<std::size_t>(std::max(bound.placeholder, 0));
      const bool is_given = bound.placeholder != none && place_of < arguments.size();
      all.push_back(is_given                    ? arguments[place_of]
                    : bound.placeholder != none ? unknown_value()
                                                : bound.value);
    }
  } else {
    all = arguments;
  }
  if (all.size() > function.parameters.size()) all.resize(function.parameters.size());
  return inline_function(callable.function, callable.self, all, callable.frame, place);
}

}  // namespace maide::extract
