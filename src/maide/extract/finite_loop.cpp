#include "maide/extract/finite_loop.hpp"

#include <algorithm>
#include <set>
#include <string>

#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

using Form = Expression::Kind;

// What lets a container grow that has no name of its own.
const std::set<std::string> growing{"push_back", "emplace_back", "push_front", "emplace_front",
                                    "insert",    "emplace",      "resize",     "append"};

// Names in an expression, those of members among them.
void add_names(const Expression& expression, std::set<std::string>& names) {
  if (expression.kind == Form::name || expression.kind == Form::member) {
    names.insert(expression.text);
  }
  for (const Expression& operand : expression.operands) add_names(operand, names);
}

bool is_of_sources(const std::string& type, const Sources& sources) {
  const std::string name = last_part(class_of_type(type));
  return std::ranges::any_of(sources.classes, [&](const auto& entry) {
    return last_part(entry.first) == name && !entry.second.is_enumeration;
  });
}

// Whether it may be a function of the sources: what a library has knows nothing of their variables
// but its arguments.
bool is_own(const Expression& callee, const Sources& sources) {
  const std::string name = last_part(callee.text);
  if (!callee.type.empty() && is_of_sources(callee.type, sources)) return true;  // it makes one
  return callee.function != none || callee.variable != none ||
         std::ranges::any_of(sources.functions,
                             [&](const Function& function) { return function.name == name; });
}

// Whether the expression may change one of these, or hand it to somebody who does. Reading an
// element and asking for the size do not.
// `sources`: their other functions may know them, too; null: they do not.
bool may_change(const Expression& expression, const std::set<std::string>& names,
                const Sources* sources) {
  static const std::set<std::string> reads{"size", "length", "empty", "at",    "begin",
                                           "end",  "front",  "back",  "c_str", "data"};
  const auto names_one = [&](const Expression& inner) {
    std::set<std::string> used;
    add_names(inner, used);
    return std::ranges::any_of(used, [&](const std::string& name) { return names.contains(name); });
  };
  const bool is_step = expression.kind == Form::other &&
                       (expression.text == "++" || expression.text == "--" ||
                        (expression.text == "&" && expression.operands.size() == 1));
  if ((expression.kind == Form::assign || is_step) && names_one(expression.operands[0])) {
    return true;
  }
  if (expression.kind == Form::lambda) return true;
  if (expression.kind == Form::call) {
    const Expression& callee = expression.operands[0];
    if (callee.kind == Form::name && callee.variable != none) return true;
    if (sources != nullptr && is_own(callee, *sources)) return true;
    if (callee.kind == Form::member && names.contains(callee.text)) return true;
    const bool is_read = callee.kind == Form::member && reads.contains(callee.text);
    for (std::size_t i = is_read ? 1 : 0; i < expression.operands.size(); ++i) {
      const Expression& part = expression.operands[i];
      const bool is_place = part.kind == Form::name || part.kind == Form::member;
      if (is_place && names_one(part)) return true;
    }
  }
  return std::ranges::any_of(expression.operands, [&](const Expression& operand) {
    return may_change(operand, names, sources);
  });
}

bool may_change(const Statement& statement, const std::set<std::string>& names,
                const Sources* sources) {
  if (statement.kind == Statement::Kind::opaque) return true;
  const bool makes =
      sources != nullptr && statement.kind == Statement::Kind::declaration &&
      is_of_sources(sources->variables[static_cast<std::size_t>(statement.variable)].type,
                    *sources);
  if (makes) return true;
  return std::ranges::any_of(statement.expressions,
                             [&](const Expression& e) { return may_change(e, names, sources); }) ||
         std::ranges::any_of(statement.blocks, [&](const auto& block) {
           return std::ranges::any_of(
               block, [&](const Statement& s) { return may_change(s, names, sources); });
         });
}

bool is_changed_in_body(const Statement& loop, const std::set<std::string>& names,
                        const Sources* sources) {
  return std::ranges::any_of(loop.blocks.back(),
                             [&](const Statement& s) { return may_change(s, names, sources); });
}

// A bound that only the body could change: literals, local numbers, the size of a local container.
bool is_still(const Expression& bound, const Sources& sources) {
  if (bound.kind == Form::literal) return true;
  if (bound.kind == Form::name) {
    if (bound.variable == none) return false;
    const Variable& variable = sources.variables[static_cast<std::size_t>(bound.variable)];
    return (variable.is_local && !variable.is_reference && !variable.is_pointer) ||
           variable.type.starts_with("const ");
  }
  if (bound.kind == Form::call && bound.operands.size() == 1 &&
      bound.operands[0].kind == Form::member && bound.operands[0].text == "size") {
    const Expression& container = bound.operands[0].operands[0];
    return container.kind == Form::name && is_still(container, sources);
  }
  return bound.kind == Form::other && bound.operands.size() == 2 &&
         (bound.text == "+" || bound.text == "-" || bound.text == "*") &&
         is_still(bound.operands[0], sources) && is_still(bound.operands[1], sources);
}

// Variables in an expression.
void add_variables(const Expression& expression, std::set<int>& variables) {
  if (expression.variable != none) variables.insert(expression.variable);
  for (const Expression& operand : expression.operands) add_variables(operand, variables);
}

bool counts(const Statement& loop, const Sources& sources, const IsShared& is_shared) {
  if (loop.blocks[0].size() != 1) return false;
  const Statement& first = loop.blocks[0].front();
  const Expression& condition = loop.expressions[0];
  const Expression& step = loop.expressions[1];
  if (first.kind != Statement::Kind::declaration || first.variable == none) return false;
  const Variable& counter = sources.variables[static_cast<std::size_t>(first.variable)];
  static const std::set<std::string> wide{"int",      "unsigned int", "long",    "size_t",
                                          "uint32_t", "std::size_t",  "int32_t", "uint64_t",
                                          "int64_t",  "uint"};
  if (!wide.contains(class_of_type(counter.type)) || counter.is_reference) return false;
  const auto is_counter = [&](const Expression& place) {
    return place.kind == Form::name && place.variable == first.variable;
  };
  const bool goes_up = condition.text == "<", goes_down = condition.text == ">";
  if (condition.kind != Form::other || condition.operands.size() != 2 || (!goes_up && !goes_down) ||
      !is_counter(condition.operands[0]) || !is_still(condition.operands[1], sources)) {
    return false;
  }
  if (step.kind != Form::other || step.text != (goes_up ? "++" : "--") ||
      !is_counter(step.operands[0])) {
    return false;
  }
  std::set<int> variables{first.variable};
  add_variables(condition.operands[1], variables);
  if (std::ranges::any_of(variables, is_shared)) return false;
  std::set<std::string> names{counter.name};
  add_names(condition.operands[1], names);
  names.erase("size");
  return !is_changed_in_body(loop, names, nullptr);
}

}  // namespace

bool is_finite_call(const Expression& call, const Function& function, const Sources& sources) {
  std::set<std::string> names;
  for (std::size_t i = 1; i < call.operands.size(); ++i) add_names(call.operands[i], names);
  for (const char* reading : {"begin", "end", "cbegin", "cend"}) names.erase(reading);
  return std::ranges::none_of(
      function.body, [&](const Statement& inner) { return may_change(inner, names, &sources); });
}

bool is_finite_loop(const Statement& loop, const Sources& sources, const IsShared& is_shared) {
  if (loop.kind == Statement::Kind::loop) return counts(loop, sources, is_shared);
  if (loop.kind != Statement::Kind::range) return false;
  std::set<std::string> names;
  add_names(loop.expressions[0], names);
  const Expression& container = loop.expressions[0];
  const bool is_local =
      container.kind == Form::name && container.variable != none &&
      sources.variables[static_cast<std::size_t>(container.variable)].is_local &&
      !sources.variables[static_cast<std::size_t>(container.variable)].is_reference &&
      !is_shared(container.variable);
  const bool is_named = container.kind == Form::name || container.kind == Form::member;
  if (!is_named) names = growing;
  return !is_changed_in_body(loop, names, is_local ? nullptr : &sources);
}

}  // namespace maide::extract
