#include "maide/check/unroll/select_steps.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "maide/check/unroll/wire_uses.hpp"

namespace maide::program_syntax {

void SelectSteps::expand_select(const Place& place, const Statement& statement,
                                const Values& values) {
  for (const SelectArm& arm : statement.select_arms) {
    const bool waits =
        arm.kind == SelectArm::Kind::otherwise || arm.kind == SelectArm::Kind::timeout;
    if (waits) {
      expand_otherwise(place, statement, arm, values);
      continue;
    }
    expand_guarded_arm(place, arm, values, {}, behind(place.frame));
  }
}

void SelectSteps::expand_guarded_arm(const Place& place, const SelectArm& arm, const Values& values,
                                     const Uses& also, FrameId next) {
  if (arm.kind == SelectArm::Kind::wake_causeless) return expand_waking(place, arm, values, 0);
  const Callback* const of = arm.starts != nullptr ? arm.starts : arm.callback;
  const std::uint32_t fair = fair_group(of, arm.line, arm.column, 0, false, text_of_arm(arm));
  if (arm.kind == SelectArm::Kind::wake) return expand_waking(place, arm, values, fair);
  Uses start = arm.starts != nullptr ? arm.starts->start : Uses{};
  if (arm.due) {
    const std::vector<bool> is_due{false, true};
    start.push_back(actions_.variable(arm.due->index, &is_due, 0));
  }
  start.insert(start.end(), also.begin(), also.end());
  if (!arm.guard) return expand_arm(place, arm, values, start, fair, next);
  for (auto& [conditions, result] : outcomes(*arm.guard, values, at(arm.line, arm.column))) {
    Uses uses = actions_.variables(conditions, {});
    if (!result.value) {
      uses.insert(uses.end(), also.begin(), also.end());
      add_combined({CombinedStep::Role::arm, std::move(uses), {}, "when", fair},
                   error_state(result.error, result.line, result.column), arm.line, arm.column);
    } else if (*result.value != 0) {
      uses.insert(uses.end(), start.begin(), start.end());
      expand_arm(place, arm, values, uses, fair, next);
    }
  }
}

std::string SelectSteps::text_of_arm(const SelectArm& arm) {
  if (arm.starts != nullptr) return arm.starts->whole_name();
  switch (arm.kind) {
    case SelectArm::Kind::input: return arm.model.name() + "." + arm.event.name;
    case SelectArm::Kind::output:
    case SelectArm::Kind::arrival: return arm.model.name() + "!" + arm.event.name;
    case SelectArm::Kind::wake: return arm.model.name() + ".wait";
    default: return "when";
  }
}

void SelectSteps::expand_waking(const Place& place, const SelectArm& arm, const Values& values,
                                std::uint32_t fair) {
  const bool is_causeless = arm.kind == SelectArm::Kind::wake_causeless;
  const std::uint32_t condition = model_of(arm.model, values);
  const auto [lock, event] = locks_.relock(condition);
  const ModelUse wake =
      locks_.wake(condition, is_causeless ? WaiterStep::wake_causeless : WaiterStep::wake);
  add_combined({is_causeless ? CombinedStep::Role::causeless : CombinedStep::Role::step,
                {wake, lock},
                {event},
                is_causeless ? "wakes without a notification"
                             : "a notification of " + actions_.model(condition).name,
                fair},
               settle(behind(place.frame), values), arm.line, arm.column);
}

void SelectSteps::expand_arm(const Place& place, const SelectArm& arm, const Values& values,
                             const Uses& conditions, std::uint32_t fair, FrameId behind_arm) {
  const auto add = [&](std::vector<ModelUse> uses, const std::vector<ModelUse>& events,
                       const std::string& text, ControlState target) {
    const std::string prefix = arm.starts != nullptr ? arm.starts->whole_name() + " starts" : "";
    std::vector<Uses> ways = actions_.combine({std::move(uses)}, {conditions});
    const bool is_timer = arm.starts != nullptr && arm.starts->kind == Callback::Kind::timer;
    std::optional<std::uint32_t> callback;
    if (arm.starts != nullptr && is_of_executor(arm.starts->kind)) callback = arm.starts->number;
    for (Uses& way : ways) {
      add_combined(
          {is_timer ? CombinedStep::Role::timer : CombinedStep::Role::arm, std::move(way), events,
           prefix + (prefix.empty() || text.empty() ? "" : ": ") + text, fair, callback},
          target, arm.line, arm.column);
    }
  };
  const FrameId next = arm.end ? enter(*arm.end, behind_arm) : behind_arm;
  if (arm.starts != nullptr && arm.starts->kind != Callback::Kind::subscription) {
    auto [uses, events] = services_.start_of(*arm.starts);
    return add(std::move(uses), events, "", settle(enter(*arm.body, next), values));
  }
  if (arm.kind == SelectArm::Kind::guard) {
    const std::string text = conditions.empty() ? "when" : text_of(conditions, actions_);
    return add({}, {}, text, settle(enter(*arm.body, next), values));
  }
  try {
    check_arm(arm, values);
  } catch (const EvaluationError& error) {
    return add({}, {}, "when", error_state(error.text, error.line, error.column));
  }
  if (arm.kind == SelectArm::Kind::arrival) {
    return add(when_all_arrived(own_wires(arm.model, arm.callback, values), actions_), {},
               text_of_arrival(arm.model, values), settle(enter(*arm.body, next), values));
  }
  if (const Topic* topic = written_topic(arm.model, arm.event.name, values)) {
    return expand_topic_arm(place, arm, *topic, values, next, add);
  }
  const std::uint32_t model = model_of(arm.model, values);
  const InterfaceAutomaton& automaton = actions_.model(model).automaton;
  const Alphabet& outputs = automaton.outputs();
  using Kind = ModelUse::Kind;
  if (names_.services.contains(model)) {
    const ServiceSteps::Arm way = services_.arm(arm, model, at(arm.line, arm.column));
    const bool gives = arm.kind == SelectArm::Kind::input;
    const Block& body = arm.body ? *arm.body : *arm.arms.front().body;
    const Service& service = names_.services.at(model);
    const ControlState target = settle(enter(body, next), values);
    for (Uses& uses : ways_to_use(service, model, way.use, actions_)) {
      add(std::move(uses),
          services_.events_of(model, gives ? arm.event.name : "", way.output.value_or("")),
          service.name + (gives ? "." + arm.event.name : "") +
              (way.output ? (gives ? " -> " : "!") + *way.output : ""),
          target);
    }
    return;
  }
  if (arm.kind == SelectArm::Kind::output) {
    for (Symbol output = 0; output < outputs.size(); ++output) {
      const std::string& name = outputs.name(output);
      if (!matches(arm.event, split_name(name), name, values)) continue;
      const ModelUse use{Kind::take, model, output};
      add({use}, {use}, actions_.model(model).name + "!" + name,
          take(arm.event, *arm.body, next, name, values));
    }
    return;
  }
  const Symbol input = input_of(model, arm.event, values);
  const std::string text = actions_.model(model).name + "." + automaton.inputs().name(input);
  const ModelUse given{Kind::give, model, input};
  const std::vector<const Arm*> taken = arms_of(model, arm.arms, values);
  bool has_arm = arm.arms.empty();
  for (const InputWay& way : ways_of(arm, model, input)) {
    if (!way.error.empty()) {
      add(way.uses, {}, way.error, error_state(way.error, arm.line, arm.column));
    } else if (way.is_beyond) {
      add(way.uses, {given}, text, control_state(place));
    } else if (!way.output) {
      add(way.uses, {given}, text, settle(enter(*arm.body, next), values));
    } else {
      const std::string& name = outputs.name(*way.output);
      const Arm* of = taken[*way.output];
      has_arm = has_arm || of != nullptr;
      const ControlState target =
          of != nullptr ? take(of->output, *of->body, next, name, values)
                        : error_state(text + " -> " + name + ": this 'select' has no arm for it",
                                      arm.line, arm.column);
      add(way.uses, {given, {Kind::take, model, *way.output}}, text + " -> " + name, target);
    }
  }
  if (!has_arm) fail_without_output(arm, text, outputs, values);
}

void SelectSteps::fail_without_output(const SelectArm& arm, const std::string& input,
                                      const Alphabet& outputs, const Values& values) const {
  for (const Arm& awaited : arm.arms) {
    const Event& event = awaited.output;
    const bool is_given = !event.arguments.empty() &&
                          std::none_of(event.arguments.begin(), event.arguments.end(),
                                       [](const auto& argument) { return argument.binds; });
    if (!is_given) continue;
    const auto& names = outputs.names();
    const bool is_written = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return matches(event, split_name(name), name, values);
    });
    if (is_written) continue;
    std::string given;
    for (const Event::Argument& argument : event.arguments) {
      const Value value = evaluate(argument.expression, values);
      given += (given.empty() ? "" : ", ") + text_of(value, argument.expression.kind);
    }
    throw ParseError("no program writes " + given + " to " + arm.model.name() + ", so " + input +
                         " never brings " + event.name + "(" + given + ")",
                     at(awaited.line, awaited.column));
  }
  throw ParseError("this arm's outputs never follow " + input + " at once",
                   at(arm.line, arm.column));
}

std::vector<SelectSteps::InputWay> SelectSteps::ways_of(const SelectArm& arm, std::uint32_t model,
                                                        Symbol input) {
  std::vector<InputWay> ways;
  const auto add = [&](const std::optional<ModelUse>& use, std::optional<Symbol> output,
                       bool is_beyond) {
    if (use) ways.push_back({{*use}, output, is_beyond});
  };
  if (const Wire* const wire = wire_for(model, input, arm.callback)) {
    for (Uses& uses : ways_to_send({{wire, input, number_}}, actions_)) {
      ways.push_back({std::move(uses), std::nullopt, false});
    }
    return ways;
  }
  if (names_.holders.contains(model)) return ways_to_lock(arm, model, input);
  const auto behind_own = when_own_arrived(model, input, arm.callback);
  const auto with_own = [&] {
    for (InputWay& way : ways) {
      if (behind_own) way.uses.push_back(*behind_own);
    }
    return ways;
  };
  const std::size_t outputs = actions_.model(model).automaton.outputs().size();
  for (Symbol output = 0; output < outputs; ++output) {
    add(actions_.input_and_output(model, input, output), output, false);
  }
  if (arm.body && ways.empty()) {
    add(ModelUse{ModelUse::Kind::give, model, input}, std::nullopt, false);
    return with_own();
  }
  if (arm.body) add(actions_.input_and_output(model, input, std::nullopt), std::nullopt, false);
  if (actions_.model(model).when_unexplored == WhenUnexplored::stop) {
    add(actions_.beyond(model, input), std::nullopt, true);
  }
  return with_own();
}

std::vector<SelectSteps::InputWay> SelectSteps::ways_to_lock(const SelectArm& arm,
                                                             std::uint32_t model, Symbol input) {
  std::vector<InputWay> ways;
  const std::size_t answers = actions_.model(model).automaton.outputs().size();
  for (Symbol answer = 0; !arm.body && answer < answers; ++answer) {
    if (const auto given = locks_.given(model, input, answer)) {
      ways.push_back({{*given}, answer, false});
    }
  }
  if (arm.body) ways.push_back({{*locks_.given(model, input)}, std::nullopt, false});
  const auto error = locks_.error_of(model, input);
  ways.push_back({{error->where}, std::nullopt, false, error->text});
  return ways;
}

void SelectSteps::expand_otherwise(const Place& place, const Statement& statement,
                                   const SelectArm& waiting, const Values& values) {
  using Guards = std::vector<std::int8_t>;  // by arm: 1 it holds, 0 it does not, -1 an error
  SharedValues known;
  const std::function<Guards(const SharedValues&)> run = [&](const SharedValues& shared) {
    Guards guards;
    for (const SelectArm& arm : statement.select_arms) {
      try {
        guards.push_back(!arm.guard || evaluate(*arm.guard, values, &shared) != 0 ? 1 : 0);
      } catch (const EvaluationError&) {
        guards.push_back(-1);
      }
    }
    return guards;
  };
  const bool is_timeout = waiting.kind == SelectArm::Kind::timeout;
  for (const auto& [conditions, guards] :
       outcomes_of(run, actions_, at(waiting.line, waiting.column), known)) {
    std::vector<Uses> ways = idle_uses(statement, guards, values);
    if (is_timeout) ways = actions_.combine({overdue_in(statement, values)}, ways);
    for (Uses& uses : ways) {
      for (const ModelUse& use : actions_.variables(conditions, {})) uses.push_back(use);
      const ControlState target = settle(enter(*waiting.body, behind(place.frame)), values);
      add_combined({is_timeout ? CombinedStep::Role::timeout : CombinedStep::Role::otherwise,
                    std::move(uses),
                    {},
                    is_timeout ? "timeout" : "otherwise",
                    0},
                   target, waiting.line, waiting.column);
    }
  }
}

Uses SelectSteps::overdue_in(const Statement& statement, const Values& values) {
  Uses overdue;
  for (const SelectArm& arm : statement.select_arms) {
    if (arm.kind == SelectArm::Kind::wake) {
      overdue.push_back(locks_.wake(model_of(arm.model, values), WaiterStep::wake_causeless));
    }
    const bool is_input = arm.kind == SelectArm::Kind::input && !arm.model.is_topic;
    if (!is_input || arm.callback != nullptr) continue;
    try {
      const std::uint32_t model = model_of(arm.model, values);
      const auto late = services_.time_out_of(arm, model);
      if (late && std::ranges::find(overdue, model, &ModelUse::model) == overdue.end()) {
        overdue.push_back(*late);
      }
    } catch (const EvaluationError&) {  // then there is no time-out
    }
  }
  return overdue;
}

std::vector<Uses> SelectSteps::idle_uses(const Statement& statement,
                                         const std::vector<std::int8_t>& guards,
                                         const Values& values) {
  std::map<std::uint32_t, std::vector<ModelUse>> by_model;
  std::map<std::pair<const Topic*, std::string>, std::vector<TopicSteps::WriteArm>> by_topic;
  std::vector<Uses> unsent{{}};
  std::map<std::uint32_t, Uses> by_service;
  for (std::size_t i = 0; i < guards.size(); ++i) {
    const SelectArm& arm = statement.select_arms[i];
    if (guards[i] == 0 || arm.kind == SelectArm::Kind::otherwise ||
        arm.kind == SelectArm::Kind::timeout) {
      continue;
    }
    if (guards[i] < 0 || arm.kind == SelectArm::Kind::guard) return {};
    if (arm.kind == SelectArm::Kind::wake_causeless) continue;
    try {
      if (arm.kind == SelectArm::Kind::arrival) {
        check_arm(arm, values);
        unsent = actions_.combine(
            unsent, ways_not_all_arrived(own_wires(arm.model, arm.callback, values), actions_));
        continue;
      }
      const bool is_input = arm.kind == SelectArm::Kind::input;
      if (const Topic* topic = written_topic(arm.model, arm.event.name, values)) {
        check_arm(arm, values);
        std::vector<TopicSteps::WriteArm>& arms = by_topic[{topic, node_of(arm.callback)}];
        if (is_input) arms.push_back({name_of(arm.event, values), kind_of(arm)});
        continue;
      }
      const std::uint32_t model = model_of(arm.model, values);
      if (arm.kind == SelectArm::Kind::wake) {
        by_model[model].push_back(locks_.wake(model, WaiterStep::wake));
        continue;
      }
      if (names_.services.contains(model)) {
        const ServiceSteps::Arm way = services_.arm(arm, model, at(arm.line, arm.column));
        ServiceModel& rules = *names_.services.at(model).rules;
        // What he may have sent may not be there yet.
        const bool is_handed_over = way.use.kind == ServiceModel::Operation::Kind::wait;
        if (is_left_to_anybody(names_.services.at(model)) && !is_handed_over) continue;
        Uses& uses = by_service[model];
        uses.push_back(rules.use(actions_, model, way.use));
        if (way.due) uses.push_back(rules.use(actions_, model, *way.due));
        continue;
      }
      if (is_input) {
        const Symbol input = input_of(model, arm.event, values);
        if (const Wire* const wire = wire_for(model, input, arm.callback)) {
          unsent = actions_.combine(unsent, ways_to_wait(*wire, actions_));
          continue;
        }
      }
      if (is_left_to_anybody(model)) continue;
      std::vector<ModelUse>& uses = by_model[model];
      if (!is_input) continue;  // quiescence says it
      for (const InputWay& way : ways_of(arm, model, input_of(model, arm.event, values))) {
        uses.push_back(way.uses.front());
      }
    } catch (const EvaluationError&) {
      return {};  // the arm is an error
    }
  }
  std::vector<Uses> ways{{}};
  for (auto& [model, taking] : by_model) {
    const auto idle = actions_.idle(model, taking);
    if (!idle) return {};
    ways.front().push_back(*idle);
  }
  for (const auto& [model, taking] : by_service) {
    ways.front().push_back(actions_.impossible(model, taking));
  }
  for (const auto& [writer, arms] : by_topic) {
    ways = actions_.combine(ways, topics_.idle_of(*writer.first, arms, writer.second));
  }
  return actions_.combine(ways, unsent);
}

TopicSteps::WriteKind SelectSteps::kind_of(const SelectArm& arm) {
  return arm.body ? TopicSteps::WriteKind::bare_arm : TopicSteps::WriteKind::arm_with_outputs;
}

template <typename Add>
void SelectSteps::expand_topic_arm(const Place& place, const SelectArm& arm, const Topic& topic,
                                   const Values& values, FrameId next, const Add& add) {
  if (arm.kind == SelectArm::Kind::output) {
    for (TopicSteps::Taking& way : topics_.takings(topic)) {
      const std::string& name = way.output;
      if (!matches(arm.event, split_name(name), name, values)) continue;
      add(std::move(way.uses), std::move(way.events), topic.name + "!" + name,
          take(arm.event, *arm.body, next, name, values));
    }
    return;
  }
  const std::string input = name_of(arm.event, values);
  const std::string text = topic.name + "." + input;
  bool has_way = arm.body != nullptr;
  for (const TopicSteps::Writing& way :
       topics_.writings(topic, input, kind_of(arm), node_of(arm.callback))) {
    ControlState target = 0;
    std::string whole = text;
    if (way.is_beyond) {
      target = control_state(place);
    } else if (!way.output) {
      target = settle(enter(*arm.body, next), values);
    } else {
      whole += " -> " + *way.output;
      const Arm* of = arm_for(*way.output, arm.arms, values);
      has_way = has_way || of != nullptr;
      target = of != nullptr
                   ? take(of->output, *of->body, next, *way.output, values)
                   : error_state(whole + ": this 'select' has no arm for it", arm.line, arm.column);
    }
    add(way.uses, way.events, whole, target);
  }
  if (!has_way) {
    const std::uint32_t reader = topic.readers.front().model;
    fail_without_output(arm, text, actions_.model(reader).automaton.outputs(), values);
  }
}

}  // namespace maide::program_syntax
