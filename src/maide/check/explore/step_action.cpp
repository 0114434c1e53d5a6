#include "maide/check/explore/step_action.hpp"

#include <algorithm>
#include <set>

#include "maide/formats/names.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

std::string shown_name(const std::string& name) {
  const bool is_plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
  return is_plain ? name : quote_name(name);
}

// The input's, output's or branch's name.
const std::string& symbol_name(const StepAction& action, const System& system) {
  static const std::string quiet = "quiet", branches[] = {"if", "else"};
  switch (action.kind) {
    case Kind::give: return system.models[action.model].automaton.inputs().name(action.symbol);
    case Kind::take: return system.models[action.model].automaton.outputs().name(action.symbol);
    case Kind::quiet: return quiet;
    case Kind::choice: break;
  }
  return branches[action.symbol];
}

StepAction action_of_edge(std::uint32_t program, const ProgramEdge& edge) {
  const bool has_symbol = edge.kind != Kind::quiet;
  return {program, edge.kind, edge.kind == Kind::choice ? 0 : edge.model,
          has_symbol ? edge.symbol : 0, false};
}

}  // namespace

StepAction action_of(const System& system, const Step& step) {
  StepAction action = action_of_edge(step.program, system.programs[step.program].edges[step.edge]);
  action.is_beyond = step.is_beyond;
  return action;
}

std::vector<StateId> states_beyond(const InterfaceAutomaton& automaton, Symbol input) {
  std::vector<StateId> states;
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (automaton.is_quiescent(state) && is_beyond_learned(automaton, state, input)) {
      states.push_back(state);
    }
  }
  return states;
}

std::vector<StepAction> step_actions(const System& system) {
  std::set<StepAction> actions;
  for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
    for (const ProgramEdge& edge : system.programs[program].edges) {
      StepAction action = action_of_edge(program, edge);
      if (!actions.insert(action).second || edge.kind != Kind::give) continue;
      const ModelInstance& model = system.models[edge.model];
      if (model.when_unexplored == WhenUnexplored::wait) continue;
      if (states_beyond(model.automaton, edge.symbol).empty()) continue;
      action.is_beyond = true;
      actions.insert(action);
    }
  }
  return {actions.begin(), actions.end()};
}

bool is_cut(const System& system, const StepAction& action) {
  return action.is_beyond && system.models[action.model].when_unexplored == WhenUnexplored::stop;
}

std::string to_string(const StepAction& action, const System& system) {
  std::string text = shown_name(system.programs[action.program].name) + " ";
  if (action.kind != Kind::choice) {
    text += shown_name(system.models[action.model].name);
    text += action.kind == Kind::give ? "?" : action.kind == Kind::take ? "!" : " ";
  }
  const std::string& symbol = symbol_name(action, system);
  text += action.kind == Kind::give || action.kind == Kind::take ? shown_name(symbol) : symbol;
  if (action.is_beyond) text += is_cut(system, action) ? " beyond" : " dropped";
  return text;
}

const std::string& ExportNames::of(std::initializer_list<std::string_view> parts) {
  const auto [entry, is_new] =
      known_.try_emplace(std::vector<std::string>(parts.begin(), parts.end()));
  if (is_new) {
    std::string wanted;
    for (const std::string_view part : parts) {
      if (part.empty()) continue;
      wanted += wanted.empty() ? "" : "_";
      wanted += part;
    }
    entry->second = identifiers_.unique(wanted);
  }
  return entry->second;
}

const std::string& ExportNames::of(const StepAction& action, const System& system,
                                   bool of_program) {
  std::string_view program;
  if (of_program) program = system.programs[action.program].name;
  const std::string& symbol = symbol_name(action, system);
  if (action.kind == Kind::choice) return of({program, "choose", symbol});
  const std::string& model = system.models[action.model].name;
  switch (action.kind) {
    case Kind::quiet: return of({program, "quiet", model});
    case Kind::take: return of({program, "out", model, symbol});
    default: break;
  }
  const std::string_view what = !action.is_beyond        ? "in"
                                : is_cut(system, action) ? "beyond"
                                                         : "dropped";
  return of({program, what, model, symbol});
}

}  // namespace maide
