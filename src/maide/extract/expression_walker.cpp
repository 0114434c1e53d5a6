#include "maide/extract/expression_walker.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/call_walker.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

using Form = Expression::Kind;

}  // namespace

std::string ExpressionWalker::truth(const Value& value) {
  switch (value.kind) {
    case Value::Kind::object: return value.is_pointer ? "true" : "";  // it may be converted
    case Value::Kind::entity:
    case Value::Kind::callable:
    case Value::Kind::future: return "true";
    default: return value.condition;
  }
}

std::vector<Value> ExpressionWalker::evaluate_all(const std::vector<Expression>& expressions,
                                                  const Place& place, std::size_t first) {
  std::vector<Value> values;
  std::size_t acting = 0;
  for (std::size_t i = first; i < expressions.size(); ++i) {
    const std::size_t written = writer_.written();
    values.push_back(evaluate(expressions[i]));
    acting += writer_.written() != written ? 1 : 0;
  }
  if (acting > 1) writer_.hole(place, "several arguments that communicate, in any order", false);
  return values;
}

Value ExpressionWalker::evaluate(const Expression& expression) {
  switch (expression.kind) {
    case Form::absent: return {};
    case Form::literal: return literal(expression);
    case Form::text: {
      Value value;
      value.kind = Value::Kind::text;
      value.text = expression.text;
      return value;
    }
    case Form::self: {
      Value self = walk_.values.frame().self;
      self.is_pointer = true;
      return self;
    }
    case Form::name: return name(expression);
    case Form::member: return member(expression);
    case Form::call: return walk_.calls->call(expression);
    case Form::lambda: return lambda(expression);
    case Form::assign: return assign(expression);
    case Form::conjunction:
    case Form::disjunction: return logical(expression);
    case Form::cast: {
      Value value = evaluate(expression.operands[0]);
      // It may fail.
      if (expression.text == "dynamic_cast" && value.matters()) value.kind = Value::Kind::mixed;
      return value;
    }
    case Form::conditional: return conditional(expression);
    case Form::opaque:
      writer_.hole(expression.place, expression.text, true);
      return unknown_value();
    case Form::construct:
      walk_.objects->share_arguments(expression.text, expression.operands, 0);
      return walk_.objects->construct(expression.text,
                                      evaluate_all(expression.operands, expression.place),
                                      expression.place, "");
    case Form::list: {
      const std::vector<Value> values = evaluate_all(expression.operands, expression.place);
      if (values.size() == 1) return values[0];
      if (any_matters(values)) writer_.hole(expression.place, "an end in a list", true);
      return {};
    }
    case Form::other: return operation(expression);
  }
  return unknown_value();
}

Value ExpressionWalker::literal(const Expression& expression) const {
  Value value;
  value.kind = Value::Kind::number;
  value.text = expression.text;
  if (expression.text == "true" || expression.text == "false") {
    value.kind = Value::Kind::data;
    value.condition = expression.text;
    value.text.clear();
  }
  if (expression.text == "0" || expression.text == "1") {
    value.condition = expression.text == "1" ? "true" : "false";
  }
  if (expression.text == "nullptr" || expression.text == "NULL") value.kind = Value::Kind::null;
  return value;
}

// ---- Names ----

Value ExpressionWalker::callable(int function) const {
  Value value;
  value.kind = Value::Kind::callable;
  value.callable = std::make_shared<Callable>();
  value.callable->function = function;
  value.callable->self = walk_.values.frame().self;
  return value;
}

Value ExpressionWalker::lambda(const Expression& expression) {
  Value value = callable(expression.function);
  value.callable->frame = walk_.values.shared_frame();
  walk_.values.frame().has_lambda = true;
  return value;
}

Value ExpressionWalker::name(const Expression& expression) {
  if (expression.variable != none) {
    return walk_.values.read(
        walk_.values.slot_of(walk_.variable(expression.variable), expression.variable));
  }
  if (Value found = function_of_name(expression); found.kind == Value::Kind::callable) {
    return found;
  }
  if (const ApiRow* row = find_row(expression.text)) {
    if (row->means == "inert") return data_value(row->returns);
    writer_.hole(expression.place, expression.text + " that is handed on", true);
    return unknown_value();
  }
  const Value& self = walk_.values.frame().self;
  if (self.kind == Value::Kind::object) {
    const std::string field = walk_.values.field_of(self.index, expression.text, none);
    if (walk_.object(self.index).fields.contains(field)) {
      return walk_.values.read_field(self.index, field, none);
    }
  }
  // An enumerator, or a constant of a library: a value that nobody calls.
  return unknown_value();
}

const ApiRow* ExpressionWalker::find_row(const std::string& text) const {
  if (const ApiRow* row = walk_.table.find_function(text)) return row;
  return walk_.table.find_method(outer_part(text), last_part(text));
}

// `&A::tick`, or a free function that is handed on.
Value ExpressionWalker::function_of_name(const Expression& expression) {
  const std::string& scope = walk_.values.frame().scope;
  std::vector<int> found;
  if (const Class* entry = walk_.names.find_class(outer_part(expression.text), scope)) {
    found = walk_.names.all_methods(*entry, last_part(expression.text));
    if (walk_.names.is_overridden(*entry, last_part(expression.text))) {
      writer_.hole(expression.place, "which function " + expression.text + " means", true);
    }
  } else {
    for (std::size_t count = 0; count < 4; ++count) {
      for (const int body : walk_.names.free_functions(expression.text, scope, count).bodies) {
        if (found.empty() || found.back() != body) found.push_back(body);
      }
    }
  }
  if (found.size() == 1) return callable(found.front());
  if (found.size() > 1) {
    writer_.hole(expression.place, "which function " + expression.text + " means", true);
  }
  return unknown_value();
}

Value ExpressionWalker::member(const Expression& expression) {
  Value of = evaluate(expression.operands[0]);
  if (of.kind == Value::Kind::object) {
    Value value = walk_.values.read_field(of.index, expression.text, expression.variable);
    if (value.type == "?" && of.type.ends_with("Options")) value.type.clear();
    return value;
  }
  if (of.kind == Value::Kind::future && expression.text == "future") return of;
  if (is_message_type(of.type)) return data_value("message");
  return walk_.values.data_of(expression.variable);
}

Slot ExpressionWalker::slot(const Expression& expression) {
  if (expression.kind == Form::cast) return slot(expression.operands[0]);
  if (expression.kind == Form::name && expression.variable != none) {
    return walk_.values.slot_of(walk_.variable(expression.variable), expression.variable);
  }
  Slot slot;
  if (expression.kind != Form::member) {
    evaluate(expression);
    return slot;
  }
  const Value of = evaluate(expression.operands[0]);
  slot.variable = expression.variable;
  if (of.kind == Value::Kind::object) {
    slot.kind = Slot::Kind::field;
    slot.object = of.index;
    slot.name = walk_.values.field_of(of.index, expression.text, expression.variable);
  }
  return slot;
}

void ExpressionWalker::forget(const Expression& expression) {
  if (expression.kind != Form::name && expression.kind != Form::member) return;
  writer_.unwritten([&] { walk_.values.forget(slot(expression)); });
}

void ExpressionWalker::forget_whole(const Expression& expression) {
  forget(expression);
  const bool is_part = expression.kind == Form::cast || expression.kind == Form::other ||
                       expression.kind == Form::call || expression.kind == Form::member;
  if (is_part && !expression.operands.empty()) forget_whole(expression.operands[0]);
}

void ExpressionWalker::share(const Expression& expression) {
  if (expression.kind == Form::cast || expression.kind == Form::conditional) {
    for (const Expression& operand : expression.operands) share(operand);
  }
  if (expression.kind != Form::name && expression.kind != Form::member) return;
  writer_.unwritten([&] { walk_.values.share(slot(expression)); });
}

void ExpressionWalker::set_constant(const Expression& expression, const Value& value) {
  if (expression.kind != Form::name && expression.kind != Form::member) return;
  Slot place;
  writer_.unwritten([&] { place = slot(expression); });
  if (place.kind != Slot::Kind::nowhere) walk_.values.store(place, value, expression.place);
}

// ---- Operators ----

Value ExpressionWalker::assign(const Expression& expression) {
  const std::size_t written = writer_.written();
  Value value = evaluate(expression.operands[1]);
  const bool value_acts = writer_.written() != written;
  const std::size_t between = writer_.written();
  const Expression& target = expression.operands[0];
  Value before;
  writer_.unwritten([&] { before = evaluate(target); });
  const Slot place = slot(target);
  if (value_acts && writer_.written() != between) {
    writer_.hole(expression.place, "both sides of an assignment communicate", false);
  }
  const bool is_known = walk_.names.is_known_type(before.type, walk_.values.frame().scope);
  if (!is_known && before.type != "auto" && !before.matters()) {
    writer_.hole(expression.place, "an assignment to what is of no known type", value.matters());
  }
  if (expression.text != "=") value = {};
  if (place.kind == Slot::Kind::nowhere) forget_whole(target);
  if (place.kind == Slot::Kind::nowhere && (value.matters() || before.matters())) {
    writer_.hole(expression.place, "an end is kept where it is not followed", true);
  } else {
    walk_.values.store(place, value, expression.place);
  }
  return value;
}

// A condition that is over variables of the program alone. What is any becomes a variable whose
// value is chosen here.
std::string ExpressionWalker::sure_condition(const Value& value, const Place& place) {
  if (std::string known = truth(value); !known.empty()) return known;
  std::string any = writer_.fresh("w");
  writer_.either(
      place, [&] { writer_.set(any, "true"); }, [&] { writer_.set(any, "false"); });
  return any;
}

Value ExpressionWalker::logical(const Expression& expression) {
  const bool is_and = expression.kind == Form::conjunction;
  Value left = evaluate(expression.operands[0]);
  const std::string first = truth(left);
  if (first == (is_and ? "true" : "false")) return evaluate(expression.operands[1]);
  if (!first.empty() && first == (is_and ? "false" : "true")) {
    writer_.unwritten([&] { evaluate(expression.operands[1]); });
    return left;
  }
  const std::string result = writer_.fresh("v");
  const std::string condition = sure_condition(left, expression.place);
  writer_.set(result, is_and ? "false" : "true");
  const auto other = [&] {
    const Value right = evaluate(expression.operands[1]);
    writer_.set(result, sure_condition(right, expression.place));
  };
  if (is_and) {
    writer_.branch_on(condition, expression.place, other);
  } else {
    writer_.branch_on(
        condition, expression.place, [] {}, other);
  }
  Value value;
  value.condition = result;
  value.program = writer_.program();
  return value;
}

Value ExpressionWalker::conditional(const Expression& expression) {
  const Value condition = evaluate(expression.operands[0]);
  Value one, other;
  writer_.branch_on(
      truth(condition), expression.place, [&] { one = evaluate(expression.operands[1]); },
      [&] { other = evaluate(expression.operands[2]); });
  Value value = data_value(one.type.empty() ? other.type : one.type);
  if (one.matters() || other.matters()) value.kind = Value::Kind::mixed;
  return value;
}

Value ExpressionWalker::operation(const Expression& expression) {
  const std::vector<Value> operands = evaluate_all(expression.operands, expression.place);
  const std::string& text = expression.text;
  const Value& first = operands.front();
  if (text == ",") return operands.back();
  if (text == "==" || text == "!=") return comparison(expression, operands);
  if (operands.size() == 1) return unary(expression, first);
  for (const Value& operand : operands) {
    const bool is_known = walk_.names.is_known_type(operand.type, walk_.values.frame().scope);
    if (is_known && !operand.matters()) continue;
    writer_.hole(expression.place, "'" + text + "' of what is of no known type", operand.matters());
    return unknown_value();
  }
  if (text == "[") {
    return data_value(is_message_type(first.type) ? "message"
                                                  : class_of_type(template_arguments(first.type)));
  }
  if (text == ">>") forget(expression.operands[1]);
  return arithmetic(expression, operands);
}

Value ExpressionWalker::unary(const Expression& expression, const Value& first) {
  const std::string& text = expression.text;
  if (text == "new" || text == "*" || text == "&") {
    if (text == "&") share(expression.operands[0]);
    if (text == "*" && first.kind == Value::Kind::object && !first.is_pointer) {
      writer_.hole(expression.place, "'*' of an object", true);
    }
    Value value = first.matters() || text != "new" ? first : unknown_value();
    value.is_pointer = text != "*";
    return value;
  }
  if (text == "-" && sign_of(first) == Sign::positive) {
    Value value = first;
    value.text = "-" + first.text;
    return value;
  }
  if (text == "!") {
    Value value;
    value.condition = negation(truth(first));
    value.program = first.program;
    if (!first.presence.empty()) {
      value.presence =
          first.presence.starts_with('!') ? first.presence.substr(1) : "!" + first.presence;
    }
    return value;
  }
  const bool is_known = walk_.names.is_known_type(first.type, walk_.values.frame().scope);
  if (!is_known || first.matters()) {
    writer_.hole(expression.place, "'" + text + "' of what is of no known type", first.matters());
  }
  if (text == "++" || text == "--") forget(expression.operands[0]);
  return data_value(first.type);
}

Value ExpressionWalker::comparison(const Expression& expression,
                                   const std::vector<Value>& operands) const {
  Value value;
  const bool is_first = operands[0].kind == Value::Kind::status;
  const Value& status = is_first ? operands[0] : operands.back();
  const Expression& word = expression.operands[is_first ? 1 : 0];
  const Value& other = operands[is_first ? 1 : 0];
  if (status.kind == Value::Kind::status && !status.condition.empty()) {
    const std::string last = last_part(word.text);
    if (last == "ready" || last == "SUCCESS") value.condition = status.condition;
    if (last == "timeout" || last == "TIMEOUT") value.condition = negation(status.condition);
    if (last == "INTERRUPTED") value.condition = "false";
  } else if (status.kind == Value::Kind::null || other.kind == Value::Kind::null) {
    const Value& pointer = operands[0].kind == Value::Kind::null ? operands[1] : operands[0];
    if (truth(pointer) == "true") value.condition = "false";
  } else {
    // A name of which nothing is known may be an enumerator, if the other side is a value.
    bool is_known = false;
    for (const Value& operand : operands) {
      const bool is_sure =
          walk_.names.is_known_type(operand.type, walk_.values.frame().scope) || operand.matters();
      is_known = is_known || is_sure;
      if (is_sure || operand.type == "?") continue;
      is_known = false;
      break;
    }
    if (!is_known) {
      walk_.writer.hole(expression.place, "a comparison of what is of no known type", false);
    }
  }
  if (expression.text == "!=") value.condition = negation(value.condition);
  value.program = writer_.program();
  return value;
}

Value ExpressionWalker::arithmetic(const Expression& expression,
                                   const std::vector<Value>& operands) {
  const Value& first = operands.front();
  const bool is_text = expression.text == "+" && operands[0].kind == Value::Kind::text &&
                       operands[1].kind == Value::Kind::text;
  if (!is_text) return data_value(first.type);
  Value value = first;
  value.text += operands[1].text;
  return value;
}

}  // namespace maide::extract
