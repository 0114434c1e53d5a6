#include "maide/check/unroll/unroller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/rules/thread_models.hpp"
#include "maide/check/unroll/death_steps.hpp"
#include "maide/check/unroll/wire_uses.hpp"

namespace maide::program_syntax {

Program Unroller::run() {
  begin();
  for (std::size_t next = 0; next < places_.size(); ++next) expand(places_[next]);
  return std::move(program_);
}

void Unroller::expand(const Place place) {
  Program::State state;
  state.first_edge = static_cast<std::uint32_t>(program_.edges.size());
  state.label_set = place.label_set;
  state.round = frame_rounds_[place.frame];
  state.valuation = place.valuation;
  state.error = place.error;
  const bool may_go_on = place.frame != no_frame;
  if (may_go_on) {
    const Statement& statement = statement_at(place.frame);
    state.may_rest = statement.is_idle && place.phase != Phase::writes;
    origin_ = intern_origin(statement.origin);
    expand(place, statement);
    origin_ = 0;
    if (statement.kind == Statement::Kind::select) note_guards(statement);
    if (may_die_ && life_ == nullptr) add_death(place);
  }
  if (life_ != nullptr) expand_life(place, state);
  state.edge_count = static_cast<std::uint32_t>(program_.edges.size()) - state.first_edge;
  state.waits = state.edge_count == 0 && may_go_on;
  program_.states.push_back(state);
}

void Unroller::note_guards(const Statement& statement) {
  const auto [known, is_new] =
      guard_ids_.try_emplace(&statement, static_cast<std::uint32_t>(program_.guard_lists.size()));
  if (is_new) {
    auto& guards = program_.guard_lists.emplace_back();
    for (const SelectArm& arm : statement.select_arms) {
      if (!arm.guard) continue;
      Program::Guard guard{to_string(*arm.guard, actions_.words()), arm.line, arm.column, {}};
      for_each_variable(*arm.guard, [&](const Expression& leaf) {
        if (leaf.op != Expression::Operator::local) return;
        for (std::uint32_t i = 0; i < element_count(leaf); ++i) {
          guard.variables.push_back(leaf.index + i);
        }
      });
      guards.push_back(std::move(guard));
    }
  }
  if (program_.guard_lists[known->second].empty()) return;
  program_.selects.push_back({static_cast<ControlState>(program_.states.size()), known->second});
}

void Unroller::expand(const Place& place, const Statement& statement) {
  const Values values = program_.valuations[place.valuation];
  using Kind = Statement::Kind;
  switch (statement.kind) {
    case Kind::choice: expand_choice(place, statement, values); break;
    case Kind::choose: {
      if (place.phase == Phase::writes) {
        add_write(place, statement, place.pending, values);
      } else {
        expand_any(place, statement, values);
      }
      break;
    }
    case Kind::assign: expand_assign(place, statement, values); break;
    case Kind::when:
    case Kind::repeat_while: expand_condition(place, statement, values); break;
    case Kind::atomic: expand_atomic(place, statement, values); break;
    case Kind::select: expand_select(place, statement, values); break;
    case Kind::rounds: expand_rounds(place, statement, values); break;
    case Kind::spin: expand_spin(place, statement, values); break;
    case Kind::refused_spin: expand_refused_spin(statement); break;
    case Kind::end_callback: expand_end(place, statement, values); break;
    case Kind::arrival: expand_arrival(place, statement, values); break;
    case Kind::matched: expand_matched(place, statement, values); break;
    case Kind::withdraw: expand_withdraw(place, statement, values); break;
    case Kind::run: expand_run(place, statement, values); break;
    case Kind::relock: expand_relock(place, statement, values); break;
    case Kind::kill:
    case Kind::restart:
    case Kind::end_process: expand_kill(place, statement, values); break;
    case Kind::join: {
      const Symbol join = input_of_copy(CopyInput::join);
      add_combined({CombinedStep::Role::step,
                    {{ModelUse::Kind::give, statement.copies, join}},
                    {},
                    "join " + thread_of(statement),
                    0},
                   settle(behind(place.frame), values), statement.line, statement.column);
      break;
    }
    default: expand_rendezvous(place, statement, values); break;
  }
}

void Unroller::expand_life(const Place& place, Program::State& state) {
  if (place.phase == Phase::error) return;
  if (place.phase == Phase::dead) {
    state.may_rest = true;
    return add_begin_of_life();
  }
  state.is_over = place.frame == no_frame && place.phase != Phase::dies;
  add_end_of_life(place);
}

ControlState Unroller::out_of(const Place& place, Phase phase) {
  Values values = program_.valuations[place.valuation];
  for (FrameId id = place.frame; id != no_frame;) id = leave(id, values);
  return control_state({no_frame, phase, 0, intern_values(values), 0, 0});
}

void Unroller::add_death(const Place& place) {
  const ControlState end = out_of(place, Phase::before);
  if (deaths_.empty()) deaths_ = ways_to_die(Dying{{number_}, nodes_}, names_, actions_);
  for (const Uses& uses : deaths_) {
    add_combined({CombinedStep::Role::death, uses, {}, program_.name + " dies", 0}, end,
                 program_.position.line, program_.position.column);
  }
}

void Unroller::add_end_of_life(const Place& place) {
  const std::uint32_t own = life_->number_of(number_);
  const Phase phase = life_->may_begin_anew ? Phase::dead : Phase::before;
  add_combined({CombinedStep::Role::fate,
                {use(*life_, LifeRules::Operation::Kind::end, own)},
                {},
                program_.name + " ends with its process",
                life_->group},
               out_of(place, phase), program_.position.line, program_.position.column);
}

void Unroller::add_begin_of_life() {
  const std::uint32_t own = life_->number_of(number_);
  add_combined({CombinedStep::Role::fate,
                {use(*life_, LifeRules::Operation::Kind::begin, own)},
                {},
                program_.name + " begins anew",
                life_->group},
               0, program_.position.line, program_.position.column);
}

void Unroller::expand_choice(const Place& place, const Statement& statement, const Values& values) {
  for (const Symbol branch : {0U, 1U}) {
    const Block& body = branch == 0 ? *statement.body : *statement.otherwise;
    const ControlState target = settle(enter(body, behind(place.frame)), values);
    if (!statement.is_fair) {
      add_edge({ModelUse::Kind::choice, 0, branch}, target, statement.line, statement.column);
      continue;
    }
    const std::string text = branch == 0 ? "if fair *" : "if fair *, else";
    const bool is_asked_for = branch == 0 || !statement.is_one_sided;
    const std::uint32_t fair = !is_asked_for ? 0
                                             : fair_group(statement.callback, statement.line,
                                                          statement.column, branch, true, text);
    add_combined({CombinedStep::Role::choice, {}, {}, text, fair}, target, statement.line,
                 statement.column);
  }
}

void Unroller::expand_any(const Place& place, const Statement& statement, const Values& values) {
  const auto choices = choices_of(statement, values);
  if (!choices) {
    throw ParseError("'any' chooses from more than " + std::to_string(max_outcomes) + " values",
                     at(statement.line, statement.column));
  }
  for (const Value value : *choices) {
    const std::string text = statement.target.name + " = " + text_of(value, statement.type.kind);
    std::uint32_t fair = 0;
    if (statement.is_fair) {
      fair = fair_group(statement.callback, statement.line, statement.column, value, true, text);
    }
    add_combined({CombinedStep::Role::choice, {}, {}, text, fair},
                 with_value(place, statement, value, values), statement.line, statement.column);
  }
}

void Unroller::add_write(const Place& place, const Statement& statement, Value value,
                         const Values& values) {
  const std::uint32_t model = element(statement.target, values);
  CombinedStep combined;
  combined.text = actions_.model(model).name + " = " + text_of(value, statement.type.kind);
  ControlState target = 0;
  try {
    check_range(statement.target, statement.type, value);
    combined.uses.push_back(actions_.variable(model, nullptr, value));
    target = settle(behind(place.frame), values);
  } catch (const EvaluationError& error) {
    target = error_state(error.text, error.line, error.column);
  }
  add_combined(std::move(combined), target, statement.line, statement.column);
}

void Unroller::expand_assign(const Place& place, const Statement& statement, const Values& values) {
  if (place.phase == Phase::writes) {
    return add_write(place, statement, place.pending, values);
  }
  if (!reads_shared(*statement.expression)) {
    return add_write(place, statement, evaluate(*statement.expression, values), values);
  }
  for (auto& [conditions, result] :
       outcomes(*statement.expression, values, at(statement.line, statement.column))) {
    add_reading(statement, conditions,
                result.value ? with_value(place, statement, *result.value, values)
                             : error_state(result.error, result.line, result.column));
  }
}

void Unroller::add_reading(const Statement& statement, const Conditions& conditions,
                           ControlState target) {
  CombinedStep combined;
  combined.uses = actions_.variables(conditions, {});
  combined.text = combined.uses.empty() ? "reads" : text_of(combined.uses, actions_);
  add_combined(std::move(combined), target, statement.line, statement.column);
}

void Unroller::expand_condition(const Place& place, const Statement& statement,
                                const Values& values) {
  for (auto& [conditions, result] :
       outcomes(*statement.expression, values, at(statement.line, statement.column))) {
    add_reading(statement, conditions,
                result.value ? behind_condition(place, statement, *result.value, values)
                             : error_state(result.error, result.line, result.column));
  }
}

void Unroller::expand_atomic(const Place& place, const Statement& statement, const Values& values) {
  for (auto& [conditions, result] :
       outcomes_of_atomic(statement, values, at(statement.line, statement.column))) {
    if (result.is_blocked) continue;
    CombinedStep combined;
    combined.uses = actions_.variables(conditions, result.writes);
    combined.text = combined.uses.empty() ? "atomic" : text_of(combined.uses, actions_);
    const ControlState target = result.error.empty()
                                    ? settle(behind(place.frame), result.values)
                                    : error_state(result.error, result.line, result.column);
    add_combined(std::move(combined), target, statement.line, statement.column);
  }
}

// ---- ends and threads ---------------------------------------------------------------------------

void Unroller::expand_withdraw(const Place& place, const Statement& statement,
                               const Values& values) {
  const std::uint32_t model = model_of(statement.model, values);
  const Service& service = names_.services.at(model);
  const ControlState target = settle(behind(place.frame), values);
  add_combined({CombinedStep::Role::step,
                {service.rules->use(actions_, model, {ServiceModel::Operation::Kind::withdraw}),
                 actions_.variable(*service.presence, nullptr, 0)},
                {},
                "withdraw " + service.name,
                0},
               target, statement.line, statement.column);
}

std::string Unroller::thread_of(const Statement& statement) const {
  const std::string& copies = actions_.model(statement.copies).name;
  return copies.substr(0, copies.rfind('.'));
}

void Unroller::expand_run(const Place& place, const Statement& statement, const Values& values) {
  const std::string thread = thread_of(statement);
  const ModelUse run{ModelUse::Kind::give, statement.copies, input_of_copy(CopyInput::run)};
  add_combined({CombinedStep::Role::step, {run}, {}, "run " + thread, 0},
               settle(behind(place.frame), values), statement.line, statement.column);
  const std::string none_free = "no copy of " + thread + " is free";
  add_combined({CombinedStep::Role::step,
                {actions_.impossible(statement.copies, {run})},
                {},
                "run " + thread + ": " + none_free,
                0},
               error_state(none_free, statement.line, statement.column), statement.line,
               statement.column);
}

// Who is alive dies; of who is dead a restart says that it begins anew.
void Unroller::expand_kill(const Place& place, const Statement& statement, const Values& values) {
  using Life = LifeRules::Operation::Kind;
  const auto& life = names_.lives[statement.life];
  const bool restarts = statement.kind == Statement::Kind::restart;
  const bool ends = statement.kind == Statement::Kind::end_process;
  const ControlState target = &life == life_
                                  ? control_state({no_frame, Phase::dies, 0, place.valuation, 0, 0})
                                  : settle(behind(place.frame), values);
  const auto add = [&](Uses uses, const std::string& text) {
    add_combined({CombinedStep::Role::step, std::move(uses), {}, text, 0}, target, statement.line,
                 statement.column);
  };
  const std::string what = ends ? "end" : (restarts ? "restart " : "kill ") + statement.input.name;
  for (Uses& way :
       ways_to_die(life, restarts ? Life::die_for_new : Life::die, ends, names_, actions_)) {
    add(std::move(way), what);
  }
  if (&life == life_) return;
  add({use(life, restarts ? Life::tell_to_begin : Life::is_dead)}, what + ", which is dead");
}

// ---- locks --------------------------------------------------------------------------------------

void Unroller::expand_lock(const Place& place, const Statement& statement, const Values& values,
                           std::uint32_t model, const ModelUse& given) {
  const Symbol input = input_of(model, statement.input, values);
  add_combined({CombinedStep::Role::step,
                {given},
                {{ModelUse::Kind::give, model, input}},
                actions_.model(model).name + "." + statement.input.name,
                0},
               behind_input(place, statement, values), statement.line, statement.column);
  const auto error = locks_.error_of(model, input);
  add_combined({CombinedStep::Role::step, {error->where}, {}, error->text, 0},
               error_state(error->text, statement.line, statement.column), statement.line,
               statement.column);
}

void Unroller::expand_wait(const Place& place, const Statement& statement, const Values& values,
                           std::uint32_t condition) {
  auto [uses, events] = locks_.wait(condition);
  add_combined({CombinedStep::Role::step, std::move(uses), std::move(events),
                actions_.model(condition).name + ".wait", 0},
               settle(behind(place.frame), values), statement.line, statement.column);
  const LockSteps::Error error = locks_.error_of_wait(condition);
  add_combined({CombinedStep::Role::step, {error.where}, {}, error.text, 0},
               error_state(error.text, statement.line, statement.column), statement.line,
               statement.column);
}

void Unroller::expand_relock(const Place& place, const Statement& statement, const Values& values) {
  const auto [use, event] = locks_.relock(model_of(statement.model, values));
  add_combined({CombinedStep::Role::step, {use}, {event}, "takes the mutex again", 0},
               settle(behind(place.frame), values), statement.line, statement.column);
}

// ---- inputs and outputs -------------------------------------------------------------------------

void Unroller::expand_input(const Place& place, const Statement& statement, const Values& values,
                            std::uint32_t model) {
  if (locks_.is_condition(model) && statement.input.name == "wait") {
    return expand_wait(place, statement, values, model);
  }
  const Symbol input = input_of(model, statement.input, values);
  if (const auto given = locks_.given(model, input)) {
    return expand_lock(place, statement, values, model, *given);
  }
  const ControlState target = behind_input(place, statement, values);
  if (const Topic* topic = written_topic(statement.model, statement.input.name, values)) {
    const std::string name = name_of(statement.input, values);
    for (const TopicSteps::Writing& way : topics_.writings(
             *topic, name, TopicSteps::WriteKind::statement, node_of(statement.callback))) {
      const ControlState behind = way.calls ? in_call(place) : target;
      add_combined({CombinedStep::Role::step, way.uses, way.events, topic->name + "." + name, 0},
                   behind, statement.line, statement.column);
    }
    return;
  }
  const ModelUse given{ModelUse::Kind::give, model, input};
  const Wire* const wire = wire_for(model, input, statement.callback);
  const auto behind_own = when_own_arrived(model, input, statement.callback);
  if (wire == nullptr && !behind_own) {
    return add_edge(given, target, statement.line, statement.column);
  }
  const ModelInstance& instance = actions_.model(model);
  for (Uses& uses : wire == nullptr ? std::vector<Uses>{{given, *behind_own}}
                                    : ways_to_send({{wire, input, number_}}, actions_)) {
    add_combined({CombinedStep::Role::step,
                  std::move(uses),
                  {given},
                  instance.name + "." + instance.automaton.inputs().name(input),
                  0},
                 target, statement.line, statement.column);
  }
}

void Unroller::expand_rendezvous(const Place& place, const Statement& statement,
                                 const Values& values) {
  const std::uint32_t model = model_of(statement.model, values);
  if (names_.services.contains(model)) return expand_service(place, statement, values, model);
  using Kind = ModelUse::Kind;
  if (place.phase == Phase::calls) return expand_call(place, statement, values);
  if (place.phase == Phase::before) return expand_input(place, statement, values, model);
  const std::vector<const Arm*> taken = arms_of(model, statement.arms, values);
  const Alphabet& outputs = actions_.model(model).automaton.outputs();
  for (const Arm& arm : statement.arms) {
    if (arm.is_quiet) {
      const ControlState target = settle(enter(*arm.body, behind(place.frame)), values);
      if (const Topic* topic = written_topic(statement.model, statement.input.name, values)) {
        for (Uses& uses : topics_.quiet_of(*topic, node_of(statement.callback))) {
          add_combined({CombinedStep::Role::step, std::move(uses), {}, "quiet", 0}, target,
                       arm.line, arm.column);
        }
      } else if (is_left_to_anybody(model)) {
        add_combined({CombinedStep::Role::step, {}, {}, "quiet", 0}, target, arm.line, arm.column);
      } else {
        add_edge({Kind::quiet, model, 0}, target, arm.line, arm.column);
      }
      continue;
    }
    const Topic* topic = written_topic(statement.model, arm.output.name, values);
    for (Symbol output = 0; output < outputs.size(); ++output) {
      if (taken[output] != &arm) continue;
      const std::string& name = outputs.name(output);
      const ControlState target = take(arm.output, *arm.body, behind(place.frame), name, values);
      if (topic == nullptr) {
        add_edge({Kind::take, model, output}, target, arm.line, arm.column);
      } else {
        for (TopicSteps::Taking& way : topics_.takings(*topic)) {
          if (way.output != name) continue;
          add_combined({CombinedStep::Role::step, std::move(way.uses), std::move(way.events),
                        topic->name + "!" + name, 0},
                       target, arm.line, arm.column);
        }
      }
    }
  }
}

void Unroller::expand_call(const Place& place, const Statement& statement, const Values& values) {
  const Topic& topic = *written_topic(statement.model, statement.input.name, values);
  const ControlState target = behind_input(place, statement, values);
  std::vector<const Wire*> wires = topics_.wires_to(topic, node_of(statement.callback));
  std::erase_if(wires,
                [](const Wire* const wire) { return wire == nullptr || wire->callers.empty(); });
  for (CombinedStep& end : ends_of_call(wires, number_, names_, actions_)) {
    add_combined(std::move(end), target, statement.line, statement.column);
  }
  const bool may_die = std::ranges::any_of(
      topic.readers, [](const Topic::Reader& reader) { return reader.gone.has_value(); });
  if (!may_die) return;
  add_combined({CombinedStep::Role::step,
                when_returned(wires, number_, actions_),
                {},
                topic.name + "." + name_of(statement.input, values) + " returns",
                0},
               target, statement.line, statement.column);
}

void Unroller::expand_service(const Place& place, const Statement& statement, const Values& values,
                              std::uint32_t model) {
  const Service& service = names_.services.at(model);
  const auto add = [&](const ServiceModel::Operation& use, const std::string& input,
                       const std::string& output, const std::string& text, ControlState target,
                       int line, int column) {
    for (Uses& uses : ways_to_use(service, model, use, actions_)) {
      add_combined({CombinedStep::Role::step, std::move(uses),
                    services_.events_of(model, input, output), text, 0},
                   target, line, column);
    }
  };
  const std::string& input = statement.input.name;
  if (place.phase == Phase::calls) {
    const ControlState target = behind_input(place, statement, values);
    for (CombinedStep& end :
         ends_of_answer(service, model, services_.caller_of(service), actions_)) {
      add_combined(std::move(end), target, statement.line, statement.column);
    }
    return;
  }
  if (place.phase == Phase::before) {
    const bool calls = input == "answer" && !service.callers.empty();
    const ControlState target = calls ? in_call(place) : behind_input(place, statement, values);
    return add(services_.operation_of(service, input, true, statement.callback), input, "",
               service.name + "." + input, target, statement.line, statement.column);
  }
  for (const Arm& arm : statement.arms) {
    if (!arm.is_quiet) {
      const std::string& output = arm.output.name;
      add(services_.operation_of(service, output, false, statement.callback), "", output,
          service.name + "!" + output,
          take(arm.output, *arm.body, behind(place.frame), output, values), arm.line, arm.column);
      continue;
    }
    const ServiceModel::Operation given =
        services_.operation_of(service, input, true, statement.callback);
    const ModelUse due = service.rules->use(actions_, model, ServiceSteps::due_behind(given));
    Uses none;
    if (!is_left_to_anybody(service)) none.push_back(actions_.impossible(model, {due}));
    add_combined({CombinedStep::Role::step, std::move(none), {}, "quiet", 0},
                 settle(enter(*arm.body, behind(place.frame)), values), arm.line, arm.column);
  }
}

void Unroller::expand_arrival(const Place& place, const Statement& statement,
                              const Values& values) {
  const ControlState target = settle(behind(place.frame), values);
  const std::string text = text_of_arrival(statement.model, values);
  Uses uses = when_all_arrived(own_wires(statement.model, statement.callback, values), actions_);
  add_combined({CombinedStep::Role::step, std::move(uses), {}, text, 0}, target, statement.line,
               statement.column);
}

void Unroller::expand_matched(const Place& place, const Statement& statement,
                              const Values& values) {
  const Topic& topic = names_.topics[element(statement.model.leaf, values)];
  const Others others = others_at(topic, statement);
  if (others.count() < statement.copies) {
    throw ParseError(fmt::format("{} has {} other end{} here", topic.name, others.count(),
                                 others.count() == 1 ? "" : "s"),
                     at(statement.line, statement.column));
  }
  const std::string text = topic.name + " -> matched" +
                           (statement.copies == 1 ? "" : fmt::format("({})", statement.copies));
  const ControlState target = settle(behind(place.frame), values);
  const std::size_t missing =
      statement.copies - std::min<std::size_t>(statement.copies, others.met);
  // Each choice of so many of those that are to be met is an edge.
  std::vector<bool> is_chosen(others.wires.size());
  std::fill_n(is_chosen.begin(), missing, true);
  std::size_t edges = 0;
  do {
    if (++edges > max_outcomes) {
      throw ParseError("there are too many ways to be " + text,
                       at(statement.line, statement.column));
    }
    Uses uses;
    for (std::size_t i = 0; i < is_chosen.size(); ++i) {
      if (!is_chosen[i]) continue;
      uses.push_back(maide::use(*others.wires[i], actions_, WireModel::Operation::Kind::has_met));
    }
    add_combined({CombinedStep::Role::step, std::move(uses), {}, text, 0}, target, statement.line,
                 statement.column);
  } while (std::prev_permutation(is_chosen.begin(), is_chosen.end()));
}

Unroller::Others Unroller::others_at(const Topic& topic, const Statement& statement) const {
  const std::string& node = node_of(statement.callback);
  Others others;
  const auto add = [&](const Wire* wire) {
    if (wire != nullptr && wire->rules->meets()) {
      others.wires.push_back(wire);
    } else {
      ++others.met;
    }
  };
  if (topic.has_end(number_, true, node)) {
    const std::string name = topic.name + "[" + statement.model.reader + "]";
    for (const Topic::Reader& reader : topic.readers) {
      const std::string& its = actions_.model(reader.model).name;
      if (!statement.model.reader.empty() && its != name && !is_reader_of(its, name)) continue;
      add(names_.wire_of(reader.model, node, number_));
    }
    return others;
  }
  std::size_t ends = 0;
  for (const Topic::Reader& reader : topic.readers) {
    const bool is_own = node.empty() ? reader.program == number_ && reader.callback.empty()
                                     : reader.callback.starts_with(node + ".");
    if (!is_own) continue;
    ends += topic.writer_names.size();
    const auto wires = names_.wires.find(reader.model);
    if (wires == names_.wires.end()) continue;
    for (const Wire& wire : wires->second) {
      if (wire.rules->meets()) others.wires.push_back(&wire);
    }
  }
  others.met = ends - std::min(ends, others.wires.size());
  return others;
}

void Unroller::expand_end(const Place& place, const Statement& statement, const Values& values) {
  const Callback& callback = *statement.callback;
  Uses uses = callback.end;
  for (const std::uint32_t model : statement.services) {
    const Service& service = names_.services.at(model);
    const auto client = service.client_of(callback.node, number_);
    if (!client || service.own_code.contains(callback.node)) continue;
    uses.push_back(service.rules->use(
        actions_, model, {ServiceSteps::Operation::Kind::end_run, *client, callback.asker}));
  }
  const bool is_on_several = is_of_executor(callback.kind) && !callback.end.empty();
  if (is_on_several) {
    const Uses kept = locks_.end_run();
    uses.insert(uses.end(), kept.begin(), kept.end());
  }
  const CombinedStep::Role role =
      is_of_executor(callback.kind) ? CombinedStep::Role::end : CombinedStep::Role::step;
  add_combined({role, std::move(uses), {}, callback.whole_name() + " ends", 0},
               settle(behind(place.frame), values), statement.line, statement.column);
}

}  // namespace maide::program_syntax
