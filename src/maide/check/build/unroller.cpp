#include "maide/check/build/unroller.hpp"

#include <algorithm>
#include <utility>

#include "maide/check/build/wires.hpp"

namespace maide::program_syntax {

Program Unroller::run() {
  begin();
  for (std::size_t next = 0; next < places_.size(); ++next) expand(places_[next]);
  return std::move(program_);
}

void Unroller::add_edge(const ModelUse& use, ControlState target, int line, int column) {
  look_sometimes();
  program_.edges.push_back({use, target, line, column, origin_});
}

void Unroller::add_combined(CombinedStep combined, ControlState target, int line, int column) {
  std::sort(combined.uses.begin(), combined.uses.end(),
            [](const ModelUse& a, const ModelUse& b) { return a.model < b.model; });
  const auto number = static_cast<Symbol>(program_.combined.size());
  program_.combined.push_back(std::move(combined));
  add_edge({ModelUse::Kind::combined, 0, number}, target, line, column);
}

std::uint32_t Unroller::fair_group(const Callback* callback, int line, int column, Value outcome,
                                   bool on_weak_runs, const std::string& text) {
  const auto [place, is_new] = fair_ids_.try_emplace(
      {callback, line, column, outcome}, static_cast<std::uint32_t>(program_.fair_groups.size()));
  if (is_new) program_.fair_groups.push_back({on_weak_runs, text});
  return place->second;
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
    if (may_die_) add_death(place);
  }
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

std::uint32_t Unroller::intern_origin(const std::optional<SourcePosition>& origin) {
  if (!origin) return 0;
  auto& origins = program_.origins;
  if (origins.empty()) origins.emplace_back();
  const auto [known, is_new] = origin_ids_.try_emplace({origin->file, origin->line, origin->column},
                                                       static_cast<std::uint32_t>(origins.size()));
  if (is_new) origins.push_back(*origin);
  return known->second;
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
    case Kind::end_callback: expand_end(place, statement, values); break;
    case Kind::arrival: expand_arrival(place, statement, values); break;
    default: expand_rendezvous(place, statement, values); break;
  }
}

void Unroller::add_death(const Place& place) {
  Values values = program_.valuations[place.valuation];
  for (FrameId id = place.frame; id != no_frame;) id = leave(id, values);
  const ControlState end = control_state({no_frame, Phase::before, 0, intern_values(values), 0, 0});
  for (const Uses& uses : deaths()) {
    add_combined({CombinedStep::Role::death, uses, {}, program_.name + " dies", 0}, end,
                 program_.position.line, program_.position.column);
  }
}

const std::vector<Uses>& Unroller::deaths() {
  if (!deaths_.empty()) return deaths_;
  deaths_.emplace_back();
  if (const auto own = names_.deaths.find(number_); own != names_.deaths.end()) {
    for (const auto& [model, steps] : own->second) {
      deaths_.front().push_back(actions_.action(model, program_.name + " dies",
                                                [&own_steps = steps] { return own_steps; }));
    }
  }
  for (const Topic& topic : names_.topics) {
    const std::vector<Uses> ways = deaths_at(topic);
    std::vector<Uses> all;
    for (const Uses& before : deaths_) {
      for (const Uses& way : ways) {
        all.push_back(before);
        all.back().insert(all.back().end(), way.begin(), way.end());
      }
    }
    deaths_ = std::move(all);
  }
  const Uses on_wires = when_dies(number_, names_, actions_);
  for (Uses& way : deaths_) way.insert(way.end(), on_wires.begin(), on_wires.end());
  return deaths_;
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
    const auto fair =
        fair_group(statement.callback, statement.line, statement.column, branch, true, text);
    add_combined({CombinedStep::Role::choice, {}, {}, text, fair}, target, statement.line,
                 statement.column);
  }
}

void Unroller::expand_any(const Place& place, const Statement& statement, const Values& values) {
  const Value low = evaluate(*statement.expression, values);
  const Value high = evaluate(statement.upper, values);
  if (distance(low, high) >= max_outcomes) {
    throw ParseError("'any' chooses from more than " + std::to_string(max_outcomes) + " values",
                     at(statement.line, statement.column));
  }
  for (Value value = low; value <= high; ++value) {
    const std::string text = statement.target.name + " = " + std::to_string(value);
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

std::string Unroller::text_of(const std::vector<ModelUse>& uses, const ModelActions& actions) {
  std::string text;
  for (const ModelUse& use : uses) {
    text += (text.empty() ? "" : ", ") + actions.model(use.model).actions[use.index].name;
  }
  return text;
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

// ---- atomic -------------------------------------------------------------------------------------

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

}  // namespace maide::program_syntax
