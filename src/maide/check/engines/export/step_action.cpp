#include "maide/check/engines/export/step_action.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "maide/base/invariant.hpp"
#include "maide/formats/names.hpp"

namespace maide {
namespace {

using EdgeKind = ProgramEdge::Kind;

std::string shown_name(const std::string& name) {
  const bool is_plain = !name.empty() && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
  return is_plain ? name : quote_name(name);
}

const CombinedStep& combined_step_of(const System& system, const StepAction& action) {
  if (action.actor == nobody) return system.nobodys_actions[action.index].what;
  return system.programs[action.actor].combined[action.index];
}

// The input's, output's or branch's name.
const std::string& symbol_name(const StepAction& action, const System& system) {
  static const std::string quiet = "quiet", branches[] = {"if", "else"};
  switch (action.kind) {
    case EdgeKind::give: return system.models[action.model].automaton.inputs().name(action.index);
    case EdgeKind::take: return system.models[action.model].automaton.outputs().name(action.index);
    case EdgeKind::quiet: return quiet;
    case EdgeKind::act: return system.models[action.model].actions[action.index].name;
    case EdgeKind::combined: return combined_step_of(system, action).text;
    case EdgeKind::choice: break;
  }
  return branches[action.index];
}

StepAction action_of_edge(std::uint32_t program, const ProgramEdge& edge) {
  const bool has_model = edge.kind != EdgeKind::choice && edge.kind != EdgeKind::combined;
  const bool has_index = edge.kind != EdgeKind::quiet;
  return {program, edge.kind, has_model ? edge.model : 0, has_index ? edge.index : 0, false};
}

// What is done, without who does it and whether that was never tried.
std::string text_of(const StepAction& action, const System& system) {
  const std::string& symbol = symbol_name(action, system);
  const auto model = [&] { return shown_name(system.models[action.model].name); };
  switch (action.kind) {
    case EdgeKind::give: return model() + "?" + shown_name(symbol);
    case EdgeKind::take: return model() + "!" + shown_name(symbol);
    case EdgeKind::quiet: return model() + " " + symbol;
    case EdgeKind::act:
    case EdgeKind::combined:
    case EdgeKind::choice: break;
  }
  return symbol;
}

}  // namespace

StepAction action_of(const System& system, const Step& step) {
  StepAction action = step.actor == nobody
                          ? StepAction{nobody, EdgeKind::combined, 0, step.action, false}
                          : action_of_edge(step.actor, edge_of(system, step));
  action.is_beyond = step.is_beyond;
  return action;
}

bool is_cut(const System& system, const StepAction& action) {
  const auto stops = [&](std::uint32_t model) {
    return system.models[model].when_unexplored == WhenUnexplored::stop;
  };
  if (!action.is_beyond || action.kind != EdgeKind::combined) {
    return action.is_beyond && stops(action.model);
  }
  const auto& uses = combined_step_of(system, action).uses;
  return std::ranges::any_of(uses, [&](const ModelUse& use) { return stops(use.model); });
}

ActionNames::ActionNames(const System& system) : system_(system) {
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    std::set<StepAction> actions;
    for (const ProgramEdge& edge : system.programs[index].edges) {
      actions.insert(action_of_edge(index, edge));
    }
    auto& texts = texts_.emplace_back();
    for (const StepAction& action : actions) ++texts[text_of(action, system)];
  }
  auto& texts = texts_.emplace_back();
  for (const NobodysAction& action : system.nobodys_actions) ++texts[action.what.text];
}

std::string ActionNames::number_of_combined(const StepAction& action) const {
  MAIDE_CHECK(action.kind == EdgeKind::combined);
  const std::string& text = symbol_name(action, system_);
  return texts_[actor_number(system_, action.actor)].find(text)->second == 1
             ? ""
             : fmt::format(" #{}", action.index);
}

std::string ActionNames::of(const StepAction& action) const {
  std::string text = shown_name(actor_name(system_, action.actor)) + " " + text_of(action, system_);
  if (action.kind == EdgeKind::combined) text += number_of_combined(action);
  if (action.is_beyond) text += is_cut(system_, action) ? " beyond" : " dropped";
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
  std::string program;
  // The blank tells nobody from a program of that name.
  if (of_program) program = action.actor == nobody ? "nobody " : actor_name(system, action.actor);
  const std::string& symbol = symbol_name(action, system);
  const std::string_view bound = !action.is_beyond        ? ""
                                 : is_cut(system, action) ? "beyond"
                                                          : "dropped";
  if (action.kind == EdgeKind::choice) return of({program, "choose", symbol});
  if (action.kind == EdgeKind::combined) {
    return of({program, "do", symbol, actions_.number_of_combined(action), bound});
  }
  const std::string& model = system.models[action.model].name;
  switch (action.kind) {
    case EdgeKind::quiet: return of({program, "quiet", model});
    case EdgeKind::take: return of({program, "out", model, symbol});
    case EdgeKind::act: return of({program, "do", model, symbol, bound});
    default: return of({program, action.is_beyond ? bound : "in", model, symbol});
  }
}

}  // namespace maide
