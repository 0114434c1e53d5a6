#include "maide/check/system/system.hpp"

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/formats/names.hpp"

namespace maide {
namespace {

const ProgramEdge& edge_of(const System& system, const Step& step) {
  return system.programs[step.program].edges[step.edge];
}

}  // namespace

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
  return std::any_of(transitions.begin(), transitions.end(), [&](const auto& transition) {
    return transition.absorbed && transition.action.is_input() && transition.action.symbol == input;
  });
}

std::vector<ModelStep> model_steps(const ModelInstance& model, StateId at, const ModelUse& use) {
  if (use.kind == ModelUse::Kind::act) return model.actions[use.symbol].steps[at];
  const bool takes = use.kind == ModelUse::Kind::take;
  if (!takes && !model.automaton.is_quiescent(at)) return {};
  if (use.kind == ModelUse::Kind::quiet) return {{at, false}};
  std::vector<ModelStep> steps;
  for (const auto& transition : model.automaton.transitions(at)) {
    if (transition.action.is_input() == takes || transition.action.symbol != use.symbol) continue;
    if (!transition.absorbed) steps.push_back({transition.target, false});
  }
  if (!takes && model.when_unexplored != WhenUnexplored::wait &&
      is_beyond_learned(model.automaton, at, use.symbol)) {
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

// Appends the steps of that program.
void add_steps(const System& system, const GlobalState& state, std::uint32_t index,
               std::vector<Step>& steps) {
  const Program& program = system.programs[index];
  const Program::State& control = program.states[state.programs[index]];
  for (std::uint32_t offset = 0; offset < control.edge_count; ++offset) {
    const std::uint32_t edge = control.first_edge + offset;
    add_steps(system, state, program.uses_of(program.edges[edge]), {index, edge, {}, false, false},
              steps);
  }
}

}  // namespace

bool is_possible(const System& system, const GlobalState& state, const Step& step) {
  const Program& program = system.programs[step.program];
  const Program::State& control = program.states[state.programs[step.program]];
  if (state.is_cut || step.edge < control.first_edge ||
      step.edge >= control.first_edge + control.edge_count) {
    return false;
  }
  std::vector<Step> steps;
  add_steps(system, state, program.uses_of(program.edges[step.edge]),
            {step.program, step.edge, {}, false, false}, steps);
  return std::find(steps.begin(), steps.end(), step) != steps.end();
}

std::vector<Step> enabled_steps(const System& system, const GlobalState& state) {
  std::vector<Step> steps;
  if (state.is_cut || is_error(system, state)) return steps;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    add_steps(system, state, index, steps);
  }
  return steps;
}

std::vector<Step> enabled_steps(const System& system, const GlobalState& state,
                                std::uint32_t program) {
  std::vector<Step> steps;
  if (!state.is_cut) add_steps(system, state, program, steps);
  return steps;
}

GlobalState apply(const System& system, const GlobalState& state, const Step& step) {
  GlobalState next = state;
  const ProgramEdge& edge = edge_of(system, step);
  next.programs[step.program] = edge.target;
  const auto uses = system.programs[step.program].uses_of(edge);
  for (std::size_t i = 0; i < uses.size(); ++i) next.models[uses[i].model] = step.targets[i];
  next.is_cut = step.is_cut;
  return next;
}

std::vector<ModelUse> uses_beyond(const System& system, const GlobalState& state,
                                  const Step& step) {
  std::vector<ModelUse> beyond;
  if (!step.is_beyond) return beyond;
  const auto uses = system.programs[step.program].uses_of(edge_of(system, step));
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const StateId at = state.models[uses[i].model];
    const auto steps = model_steps(system.models[uses[i].model], at, uses[i]);
    if (std::find(steps.begin(), steps.end(), ModelStep{step.targets[i], true}) != steps.end()) {
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
  return std::all_of(steps.begin(), steps.end(), [&](const Step& step) {
    return system.programs[step.program].is_death(edge_of(system, step));
  });
}

bool is_deadlock(const System& system, const GlobalState& state) {
  if (state.is_cut || is_error(system, state) || !is_over(system, state)) return false;
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState at = state.programs[index];
    if (!program.is_end(at) && !program.states[at].may_rest) return true;
  }
  return false;
}

bool is_true(const Expression& expression, const System& system, const GlobalState& state) {
  struct OutOfScope {};
  try {
    return evaluate(expression, [&](const Expression& leaf, std::uint32_t index) -> Value {
             if (leaf.op == Expression::Operator::shared) {
               return system.models[index].type.at(state.models[index]);
             }
             const auto value =
                 system.programs[leaf.owner].value_of(state.programs[leaf.owner], index);
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
    return system.programs[atom.owner].has_label(state.programs[atom.owner], atom.symbol);
  }
  if (atom.kind == Atom::Kind::end) {
    return system.programs[atom.owner].is_end(state.programs[atom.owner]);
  }
  if (atom.kind == Atom::Kind::expression) {
    return is_true(system.expressions[atom.owner], system, state);
  }
  if (last == nullptr) return false;
  return is_event_of(atom, system, last->program, edge_of(system, *last));
}

bool is_event_of(const Atom& atom, const System& system, std::uint32_t program,
                 const ProgramEdge& edge) {
  if (atom.program != Atom::any_program && atom.program != program) return false;
  const auto kind = atom.kind == Atom::Kind::input ? ModelUse::Kind::give : ModelUse::Kind::take;
  const auto events = system.programs[program].events_of(edge);
  return std::any_of(events.begin(), events.end(), [&](const ModelUse& event) {
    return event.kind == kind && event.model == atom.owner && event.symbol == atom.symbol;
  });
}

namespace {

// Whether the step may change the variable.
bool may_change(const Expression& leaf, const Program& program, std::size_t index,
                ControlState source, const ProgramEdge& edge) {
  if (leaf.op == Expression::Operator::shared) {
    const auto uses = program.uses_of(edge);
    return std::any_of(uses.begin(), uses.end(), [&](const ModelUse& use) {
      return use.model >= leaf.index && use.model - leaf.index < element_count(leaf);
    });
  }
  if (index != leaf.owner) return false;
  for (std::uint32_t i = 0; i < element_count(leaf); ++i) {
    if (program.value_of(source, leaf.index + i) != program.value_of(edge.target, leaf.index + i)) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool is_seen_by(const Atom& atom, const System& system, std::uint32_t index, ControlState source,
                const ProgramEdge& edge) {
  const Program& program = system.programs[index];
  switch (atom.kind) {
    case Atom::Kind::label:
      return index == atom.owner &&
             program.has_label(source, atom.symbol) != program.has_label(edge.target, atom.symbol);
    case Atom::Kind::end: return index == atom.owner && program.is_end(edge.target);
    case Atom::Kind::expression: {
      bool is_seen = false;
      for_each_variable(system.expressions[atom.owner], [&](const Expression& leaf) {
        is_seen = is_seen || may_change(leaf, program, index, source, edge);
      });
      return is_seen;
    }
    default: return is_event_of(atom, system, index, edge);
  }
}

}  // namespace maide
