#include "maide/check/system/system.hpp"

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/formats/names.hpp"

namespace maide {
std::string to_string(const std::vector<ConstantSetting>& settings) {
  std::string text;
  for (const auto& [name, value] : settings) {
    text += (text.empty() ? "" : ", ") + name + "=" + value;
  }
  return text;
}

std::vector<ProgramInterface> System::interfaces() const {
  std::vector<ProgramInterface> result;
  for (const ModelInstance& model : models) {
    result.push_back({model.name, &model.automaton.inputs(), &model.automaton.outputs()});
  }
  return result;
}

bool is_beyond_learned(const InterfaceAutomaton& automaton, StateId state, Symbol input) {
  if (automaton.is_unexplored(state, input)) return true;
  const auto transitions = automaton.transitions(state);
  return std::ranges::any_of(transitions, [&](const auto& transition) {
    return transition.absorbed && transition.action.is_input() && transition.action.symbol == input;
  });
}

std::vector<ModelStep> model_steps(const ModelInstance& model, StateId at, const ModelUse& use) {
  if (use.kind == ModelUse::Kind::act) return model.actions[use.index].steps[at];
  const bool takes = use.kind == ModelUse::Kind::take;
  if (!takes && !model.automaton.is_quiescent(at)) return {};
  if (use.kind == ModelUse::Kind::quiet) return {{at, false}};
  std::vector<ModelStep> steps;
  for (const auto& transition : model.automaton.transitions(at)) {
    if (transition.action.is_input() == takes || transition.action.symbol != use.index) continue;
    if (!transition.absorbed) steps.push_back({transition.target, false});
  }
  if (!takes && model.when_unexplored != WhenUnexplored::wait &&
      is_beyond_learned(model.automaton, at, use.index)) {
    steps.push_back({at, true});
  }
  return steps;
}

GlobalState initial_state(const System& system) {
  GlobalState state;
  for (const ModelInstance& model : system.models)
    state.models.push_back(model.automaton.initial());
  state.programs.resize(system.programs.size(), 0);
  return state;
}

namespace {

// Appends the step with each outcome of its uses, the last one varying fastest.
void add_steps(const System& system, const GlobalState& state, std::span<const ModelUse> uses,
               const Step& begun, std::vector<Step>& steps) {
  if (begun.targets.size() == uses.size()) {
    steps.push_back(begun);
    return;
  }
  const ModelUse& use = uses[begun.targets.size()];
  for (const ModelStep& met : model_steps(system.models[use.model], state.models[use.model], use)) {
    Step step = begun;
    step.targets.push_back(met.target);
    step.is_beyond = step.is_beyond || met.is_beyond;
    step.is_cut = step.is_cut || cuts(system.models[use.model], met);
    add_steps(system, state, uses, step, steps);
  }
}

// Actions of the actor, from which its steps are those that are possible.
struct ActionRange {
  std::uint32_t first = 0, count = 0;
};
ActionRange actions_of(const System& system, const GlobalState& state, std::uint32_t actor) {
  if (actor == nobody) return {0, static_cast<std::uint32_t>(system.nobodys_actions.size())};
  const Program::State& control = system.programs[actor].states[state.programs[actor]];
  return {control.first_edge, control.edge_count};
}

// Appends the steps of that actor.
void add_steps(const System& system, const GlobalState& state, std::uint32_t actor,
               std::vector<Step>& steps) {
  const ActionRange actions = actions_of(system, state, actor);
  for (std::uint32_t offset = 0; offset < actions.count; ++offset) {
    const Step begun{actor, actions.first + offset, {}, false, false};
    add_steps(system, state, uses_of(system, begun), begun, steps);
  }
}

}  // namespace

bool is_possible(const System& system, const GlobalState& state, const Step& step) {
  const ActionRange actions = actions_of(system, state, step.actor);
  if (state.is_cut || step.action < actions.first || step.action >= actions.first + actions.count) {
    return false;
  }
  std::vector<Step> steps;
  add_steps(system, state, uses_of(system, step), {step.actor, step.action, {}, false, false},
            steps);
  return std::ranges::find(steps, step) != steps.end();
}

std::vector<Step> enabled_steps(const System& system, const GlobalState& state) {
  std::vector<Step> steps;
  if (state.is_cut || is_error(system, state)) return steps;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    add_steps(system, state, index, steps);
  }
  add_steps(system, state, nobody, steps);
  return steps;
}

std::vector<Step> enabled_steps(const System& system, const GlobalState& state,
                                std::uint32_t actor) {
  std::vector<Step> steps;
  if (!state.is_cut) add_steps(system, state, actor, steps);
  return steps;
}

GlobalState apply(const System& system, const GlobalState& state, const Step& step) {
  GlobalState next = state;
  if (step.actor != nobody) next.programs[step.actor] = edge_of(system, step).target;
  const auto uses = uses_of(system, step);
  for (std::size_t i = 0; i < uses.size(); ++i) next.models[uses[i].model] = step.targets[i];
  next.is_cut = step.is_cut;
  return next;
}

std::vector<ModelUse> uses_beyond(const System& system, const GlobalState& state,
                                  const Step& step) {
  std::vector<ModelUse> beyond;
  if (!step.is_beyond) return beyond;
  const auto uses = uses_of(system, step);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const StateId at = state.models[uses[i].model];
    const auto steps = model_steps(system.models[uses[i].model], at, uses[i]);
    if (std::ranges::find(steps, ModelStep{step.targets[i], true}) != steps.end()) {
      beyond.push_back(uses[i]);
    }
  }
  return beyond;
}

bool cuts(const ModelInstance& model, const ModelStep& step) {
  return step.is_beyond && model.when_unexplored == WhenUnexplored::stop;
}

bool has_ended(const System& system, const GlobalState& state) {
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    if (!system.programs[index].is_end(state.programs[index])) return false;
  }
  return true;
}

bool is_error(const System& system, const GlobalState& state) {
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    if (system.programs[index].is_error(state.programs[index])) return true;
  }
  return false;
}

bool is_over(const System& system, const GlobalState& state) {
  const std::vector<Step> steps = enabled_steps(system, state);
  return std::ranges::none_of(steps, [&](const Step& step) { return is_progress(system, step); });
}

bool is_deadlock(const System& system, const GlobalState& state) {
  if (state.is_cut || is_error(system, state) || !is_over(system, state)) return false;
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState at = state.programs[index];
    if (!program.is_end(at) && !program.may_rest(at)) return true;
  }
  return false;
}

CombinedStep as_combined_step(const ModelUse& use, const ModelInstance* model) {
  CombinedStep step;
  if (use.kind == ModelUse::Kind::choice) {
    step.role = CombinedStep::Role::choice;
    step.text = use.index == 0 ? "if *" : "if *, else";
    return step;
  }
  step.uses = {use};
  step.text = model->name;
  if (use.kind == ModelUse::Kind::give) {
    step.text += "." + model->automaton.inputs().name(use.index);
  } else if (use.kind == ModelUse::Kind::take) {
    step.text += "!" + model->automaton.outputs().name(use.index);
  } else {
    return step;
  }
  step.events = {use};
  return step;
}

std::span<const ModelUse> uses_of(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].what.uses;
  return system.programs[step.actor].uses_of(edge_of(system, step));
}

std::span<const ModelUse> events_of(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].what.events;
  return system.programs[step.actor].events_of(edge_of(system, step));
}

const CombinedStep* combined_step_of(const System& system, const Step& step) {
  if (step.actor == nobody) return &system.nobodys_actions[step.action].what;
  const ProgramEdge& edge = edge_of(system, step);
  if (edge.kind != ModelUse::Kind::combined) return nullptr;
  return &system.programs[step.actor].combined[edge.index];
}

const ProgramEdge& edge_of(const System& system, const Step& step) {
  MAIDE_CHECK(step.actor != nobody);
  return system.programs[step.actor].edges[step.action];
}

bool is_progress(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].counts_for_deadlock;
  return system.programs[step.actor].is_progress(edge_of(system, step));
}

bool is_shown(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].is_shown;
  return system.programs[step.actor].flags.is_shown;
}

SourcePosition place_of(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].position;
  const ProgramEdge& edge = edge_of(system, step);
  return {system.programs[step.actor].position.file, edge.line, edge.column};
}

std::optional<SourcePosition> origin_of(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].origin;
  const std::uint32_t origin = edge_of(system, step).origin;
  if (origin == 0) return std::nullopt;
  return system.programs[step.actor].origins[origin];
}

std::uint32_t doer_of(const System& system, const Step& step) {
  if (step.actor == nobody) return nobody;
  return system.programs[step.actor].is_by_itself(edge_of(system, step)) ? nobody : step.actor;
}

std::string lost_by(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].lost;
  const CombinedStep* const combined = combined_step_of(system, step);
  if (combined == nullptr || combined->role != CombinedStep::Role::loss) return "";
  return "a message of " + combined->text.substr(0, combined->text.find('!'));
}

std::string actor_name(const System& system, std::uint32_t actor) {
  return actor == nobody ? "nobody" : system.programs[actor].name;
}

std::size_t actor_number(const System& system, std::uint32_t actor) {
  return actor == nobody ? system.programs.size() : actor;
}

std::size_t actor_count(const System& system) {
  return system.programs.size() + (system.nobodys_actions.empty() ? 0 : 1);
}

bool is_dead(const System& system, const GlobalState& state, std::uint32_t program) {
  const auto& life = system.programs[program].life;
  return life && life->is_dead[state.models[life->model]];
}

bool has_errors(const System& system) {
  return std::ranges::any_of(system.programs, [](const Program& program) {
    return std::ranges::any_of(program.states, [](const auto& state) { return state.error != 0; });
  });
}

bool has_idle_steps(const System& system) {
  return !std::ranges::all_of(system.nobodys_actions, &NobodysAction::counts_for_deadlock) ||
         !std::ranges::all_of(system.programs, [](const Program& program) {
           return std::ranges::all_of(
               program.edges, [&](const ProgramEdge& edge) { return program.is_progress(edge); });
         });
}

bool is_true(const Expression& expression, const System& system, const GlobalState& state) {
  struct OutOfScope {};
  try {
    return evaluate(expression, [&](const Expression& leaf, std::uint32_t index) -> Value {
             if (leaf.op == Expression::Operator::shared) {
               return system.models[index].type.at(state.models[index]);
             }
             const Program& owner = system.programs[leaf.owner];
             const auto value = is_dead(system, state, leaf.owner)
                                    ? owner.life->first_values[index]
                                    : owner.value_of(state.programs[leaf.owner], index);
             if (!value) throw OutOfScope{};
             return *value;
           }) != 0;
  } catch (const OutOfScope&) {
    return false;
  } catch (const EvaluationError&) {
    return false;
  }
}

std::string source_line(const System& system, const Program& program, int line) {
  const auto source = system.sources.find(program.position.file);
  if (source == system.sources.end() || line < 1) return "";
  const std::vector<std::string_view> lines = split(source->second, '\n');
  const auto index = static_cast<std::size_t>(line) - 1;
  return index < lines.size() ? std::string(trim(lines[index])) : "";
}

bool is_true(const Atom& atom, const System& system, const GlobalState& state, const Step* last) {
  if (atom.kind == Atom::Kind::label) {
    return system.programs[atom.owner].has_label(state.programs[atom.owner], atom.symbol) &&
           !is_dead(system, state, atom.owner);
  }
  if (atom.kind == Atom::Kind::end) {
    const Program& program = system.programs[atom.owner];
    return is_dead(system, state, atom.owner)
               ? program.life->is_dead_for_good[state.models[program.life->model]]
               : program.is_end(state.programs[atom.owner]);
  }
  if (atom.kind == Atom::Kind::expression) {
    return is_true(system.expressions[atom.owner], system, state);
  }
  if (last == nullptr) return false;
  return is_event_of(atom, doer_of(system, *last), events_of(system, *last));
}

bool is_event_of(const Atom& atom, std::uint32_t actor, std::span<const ModelUse> events) {
  if (atom.program != Atom::any_program && atom.program != actor) return false;
  const auto kind = atom.kind == Atom::Kind::input ? ModelUse::Kind::give : ModelUse::Kind::take;
  return std::ranges::any_of(events, [&](const ModelUse& event) {
    return event.kind == kind && event.model == atom.owner && event.index == atom.symbol;
  });
}

}  // namespace maide
