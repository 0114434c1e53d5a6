#include "maide/check/unroll/evaluator.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/check/rules/model_ends.hpp"

namespace maide::program_syntax {

Value Evaluator::evaluate(const Expression& expression, const Values& values,
                          const SharedValues* shared, const SharedValues* writes) const {
  return maide::evaluate(expression, [&](const Expression& leaf, std::uint32_t index) {
    if (!is_shared(leaf)) {
      MAIDE_CHECK(values[index].has_value());
      return *values[index];
    }
    MAIDE_CHECK(shared != nullptr);
    if (writes != nullptr) {
      if (const auto place = writes->find(index); place != writes->end()) return place->second;
    }
    const auto place = shared->find(index);
    if (place == shared->end()) throw SharedDemand{index};
    return place->second;
  });
}

std::vector<Outcome<Result>> Evaluator::outcomes(const Expression& expression, const Values& values,
                                                 const SourcePosition& where) const {
  SharedValues known;
  return outcomes_of<Result>(
      [&](const SharedValues& shared) {
        try {
          return Result{evaluate(expression, values, &shared), "", 0, 0};
        } catch (const EvaluationError& error) {
          return Result{std::nullopt, error.text, error.line, error.column};
        }
      },
      actions_, where, known);
}

std::vector<Outcome<AtomicResult>> Evaluator::outcomes_of_atomic(
    const Statement& statement, const Values& values, const SourcePosition& where) const {
  SharedValues known;
  const std::function<AtomicResult(const SharedValues&)> run = [&](const SharedValues& shared) {
    AtomicResult result{false, values, {}, "", 0, 0};
    try {
      if (statement.expression && evaluate(*statement.expression, values, &shared) == 0) {
        return AtomicResult{true, {}, {}, "", 0, 0};
      }
      execute(*statement.body, shared, result);
    } catch (const EvaluationError& error) {
      result = {false, {}, {}, error.text, error.line, error.column};
    }
    return result;
  };
  return outcomes_of(run, actions_, where, known);
}

void Evaluator::execute(const Block& block, const SharedValues& shared,
                        AtomicResult& result) const {
  for (const Statement& statement : block.statements) {
    if (statement.kind == Statement::Kind::skip) continue;
    if (statement.kind == Statement::Kind::repeat_for) {
      execute_rounds(statement, shared, result);
      continue;
    }
    const Value value = evaluate(*statement.expression, result.values, &shared, &result.writes);
    if (statement.kind == Statement::Kind::when) {
      execute(branch(statement, value), shared, result);
    } else if (is_shared(statement.target)) {
      check_range(statement.target, statement.type, value);
      result.writes[element(statement.target, result.values)] = value;
    } else {
      set(statement.target, statement.type, value, result.values);
    }
  }
}

void Evaluator::execute_rounds(const Statement& statement, const SharedValues& shared,
                               AtomicResult& result) const {
  const Value low = evaluate(*statement.expression, result.values);
  const Value high = evaluate(statement.upper, result.values);
  if (low > high) return;
  if (distance(low, high) >= max_outcomes) {
    throw EvaluationError{
        "'for' in 'atomic' goes round more than " + std::to_string(max_outcomes) + " times",
        statement.line, statement.column};
  }
  for (Value round = low; round <= high; ++round) {
    result.values[statement.target.index] = round;
    execute(*statement.body, shared, result);
  }
  result.values[statement.target.index].reset();
}

std::uint32_t Evaluator::element(const Expression& leaf, const Values& values) const {
  std::vector<Value> indices;
  for (const Expression& index : leaf.operands) indices.push_back(evaluate(index, values));
  return leaf.index + element_of(leaf, indices);
}

const Topic* Evaluator::written_topic(const ModelReference& model, const std::string& event,
                                      const Values& values) const {
  if (!model.is_topic) return nullptr;
  const Topic& topic = names_.topics[element(model.leaf, values)];
  const InterfaceAutomaton& automaton = actions_.model(topic.readers.front().model).automaton;
  return is_of_writer(automaton, event) ? &topic : nullptr;
}

void Evaluator::check_end(const ModelReference& model, const Event& event,
                          const Values& values) const {
  check_end(model, written_topic(model, event.name, values) != nullptr, event, values);
}

void Evaluator::check_end(const ModelReference& model, bool writes, const Event& event,
                          const Values& values) const {
  if (!model.is_topic) return;
  const Topic& topic = names_.topics[element(model.leaf, values)];
  if (topic.has_end(number_, writes, event.node)) return;
  throw EvaluationError{"this " + std::string(event.node.empty() ? "program" : "node") + " is no " +
                            (writes ? "writer" : "reader") + " of " + topic.name,
                        event.line, event.column};
}

std::uint32_t Evaluator::model_of(const ModelReference& model, const Values& values) const {
  const std::uint32_t number = element(model.leaf, values);
  if (!model.is_topic) return number;
  for (const Topic::Reader& reader : names_.topics[number].readers) {
    if (reader.program == number_) return reader.model;
  }
  return names_.topics[number].readers.front().model;
}

std::string Evaluator::text_of(Value value, ValueKind kind) const {
  return to_string(value, kind, actions_.words());
}

void Evaluator::check_range(const Expression& target, const ValueType& type, Value value) const {
  if (type.contains(value)) return;
  throw EvaluationError{target.name + " = " + text_of(value, type.kind) + " is outside of " +
                            to_string(type, actions_.words()),
                        target.line, target.column};
}

void Evaluator::set(const Expression& target, const ValueType& type, Value value,
                    Values& values) const {
  check_range(target, type, value);
  values[element(target, values)] = value;
}

// ---- inputs and outputs -------------------------------------------------------------------------

std::string Evaluator::name_of(const Event& event, const Values& values) const {
  if (!event.has_arguments) return event.name;
  std::string name;
  for (const auto& argument : event.arguments) {
    name += name.empty() ? "" : ",";
    name += text_of(evaluate(argument.expression, values), argument.expression.kind);
  }
  return event.name + "(" + name + ")";
}

Symbol Evaluator::input_of(std::uint32_t model, const Event& event, const Values& values) const {
  const std::string name = name_of(event, values);
  const ModelInstance& instance = actions_.model(model);
  if (const auto symbol = instance.automaton.inputs().find(name)) return *symbol;
  throw EvaluationError{"model " + instance.name + " has no input '" + name + "'", event.line,
                        event.column};
}

bool Evaluator::matches(const Event& pattern, const NameParts& output, const std::string& symbol,
                        const Values& values) const {
  if (pattern.is_any || (pattern.name == symbol && !pattern.has_arguments)) return true;
  if (pattern.name != output.name || output.arguments.empty()) return false;
  if (!pattern.has_arguments) return true;
  if (pattern.arguments.size() != output.arguments.size()) return false;
  for (std::size_t i = 0; i < output.arguments.size(); ++i) {
    const auto& argument = pattern.arguments[i];
    if (argument.binds) continue;
    const Value value = evaluate(argument.expression, values);
    if (text_of(value, argument.expression.kind) != output.arguments[i]) return false;
  }
  return true;
}

bool Evaluator::binds(const Event& pattern) {
  return !pattern.has_arguments || std::any_of(pattern.arguments.begin(), pattern.arguments.end(),
                                               [](const auto& argument) { return argument.binds; });
}

const Arm* Evaluator::arm_for(const std::string& output, const std::vector<Arm>& arms,
                              const Values& values) const {
  for (const bool takes_any : {false, true}) {
    for (const Arm& arm : arms) {
      if (arm.is_quiet || binds(arm.output) != takes_any) continue;
      if (matches(arm.output, split_name(output), output, values)) return &arm;
    }
  }
  return nullptr;
}

std::vector<const Arm*> Evaluator::arms_of(std::uint32_t model, const std::vector<Arm>& arms,
                                           const Values& values) const {
  std::vector<const Arm*> result;
  for (const std::string& output : actions_.model(model).automaton.outputs().names()) {
    result.push_back(arm_for(output, arms, values));
  }
  return result;
}

Values Evaluator::bind(const Event& pattern, const std::string& output, Values values) {
  if (!pattern.has_arguments) return values;
  const NameParts parts = split_name(output);
  for (std::size_t i = 0; i < pattern.arguments.size(); ++i) {
    const auto& argument = pattern.arguments[i];
    if (!argument.binds) continue;
    auto [kind, value] = read_value(parts.arguments[i], actions_.words());
    if (argument.type.kind == ValueKind::word && kind != ValueKind::word) {
      value = actions_.words().intern(parts.arguments[i]);
      kind = ValueKind::word;
    }
    if (kind != argument.type.kind) {
      throw EvaluationError{"'" + output + "' does not fit into " + argument.expression.name,
                            pattern.line, pattern.column};
    }
    Expression target = argument.expression;
    target.line = pattern.line;
    target.column = pattern.column;
    set(target, argument.type, value, values);
  }
  return values;
}

}  // namespace maide::program_syntax
