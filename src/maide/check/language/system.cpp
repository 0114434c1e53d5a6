#include "maide/check/language/system.hpp"

#include <algorithm>
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

std::vector<ModelStep> model_steps(const ModelInstance& model, StateId at,
                                   const ProgramEdge& edge) {
  const bool takes = edge.kind == ProgramEdge::Kind::take;
  if (!takes && !model.automaton.is_quiescent(at)) return {};
  if (edge.kind == ProgramEdge::Kind::quiet) return {{at, false}};
  std::vector<ModelStep> steps;
  for (const auto& transition : model.automaton.transitions(at)) {
    if (transition.action.is_input() == takes || transition.action.symbol != edge.symbol) continue;
    if (!transition.absorbed) steps.push_back({transition.target, false});
  }
  if (!takes && model.when_unexplored != WhenUnexplored::wait &&
      is_beyond_learned(model.automaton, at, edge.symbol)) {
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

std::vector<Step> enabled_steps(const System& system, const GlobalState& state) {
  std::vector<Step> steps;
  if (state.is_cut) return steps;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const Program::State& control = program.states[state.programs[index]];
    for (std::uint32_t offset = 0; offset < control.edge_count; ++offset) {
      Step step{index, control.first_edge + offset, 0, false};
      const ProgramEdge& edge = program.edges[step.edge];
      if (edge.kind == ProgramEdge::Kind::choice) {
        steps.push_back(step);
        continue;
      }
      for (const ModelStep& met :
           model_steps(system.models[edge.model], state.models[edge.model], edge)) {
        step.model_target = met.target;
        step.is_beyond = met.is_beyond;
        steps.push_back(step);
      }
    }
  }
  return steps;
}

GlobalState apply(const System& system, const GlobalState& state, const Step& step) {
  GlobalState next = state;
  const ProgramEdge& edge = edge_of(system, step);
  next.programs[step.program] = edge.target;
  if (edge.kind != ProgramEdge::Kind::choice) next.models[edge.model] = step.model_target;
  next.is_cut = step.is_beyond && system.models[edge.model].when_unexplored == WhenUnexplored::stop;
  return next;
}

bool has_ended(const System& system, const GlobalState& state) {
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    if (!system.programs[index].is_end(state.programs[index])) return false;
  }
  return true;
}

bool is_deadlock(const System& system, const GlobalState& state) {
  return !state.is_cut && !has_ended(system, state) && enabled_steps(system, state).empty();
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
  if (last == nullptr) return false;
  const ProgramEdge& edge = edge_of(system, *last);
  const auto kind =
      atom.kind == Atom::Kind::input ? ProgramEdge::Kind::give : ProgramEdge::Kind::take;
  return edge.kind == kind && edge.model == atom.owner && edge.symbol == atom.symbol;
}

}  // namespace maide
