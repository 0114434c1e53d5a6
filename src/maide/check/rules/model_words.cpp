#include "maide/check/rules/model_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "maide/base/text.hpp"
#include "maide/check/rules/built_in_models.hpp"

namespace maide {

std::string describe_bound(const ModelInstance& model) {
  if (has_unknown_depth(model.automaton)) {
    return "how much " + model.name + " keeps is not known (depth: unknown)";
  }
  if (const auto callback = find_unknown_code(model.automaton)) {
    return "what " + *callback + " does is not known (do: unknown)";
  }
  const auto bound = model.automaton.origin.find("bound");
  if (bound == model.automaton.origin.end()) {
    return model.name + " was learned up to a bound that its file does not name";
  }
  const std::string& text = bound->second;
  if (model.is_grown) {
    return fmt::format("{} was made with the {} (a smaller {} has fewer)", model.name, text,
                       model.source == ModelInstance::Source::service ? "depth" : "size");
  }
  const bool is_number =
      !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return fmt::format("{} was learned for {}", model.name, text);
  return fmt::format("{} was learned for at most {} message{} in flight", model.name, text,
                     text == "1" ? "" : "s");
}

std::string describe_built_in(const ModelInstance& model) {
  const InterfaceAutomaton& automaton = model.automaton;
  if (const BuiltInModel* const known = find_built_in(model.origin)) {
    if (known->option.empty()) return fmt::format("a {}", known->name);
    return fmt::format("a {} of {} {}", known->name, known->option,
                       automaton.origin.at(std::string(known->option)));
  }
  if (has_unknown_depth(automaton)) return "a queue of unknown depth";
  for (const std::string kind : {"size", "depth"}) {
    const auto number = automaton.origin.find(kind);
    if (number != automaton.origin.end()) return "a queue of " + kind + " " + number->second;
  }
  // The reader asks last; what is before it writes.
  std::size_t size = 0;
  for (StateId state = automaton.initial();; ++size) {
    const auto transitions = automaton.transitions(state);
    const auto write = std::ranges::find_if(transitions, [](const auto& way) {
      return way.action == Action{Action::Kind::input, 0};
    });
    if (write == transitions.end()) return fmt::format("a queue of size {}", size);
    if (write->target == state) return fmt::format("a queue of depth {}", size);
    state = write->target;
  }
}

std::string describe_refusal(const ModelInstance& model, Symbol input) {
  const std::string& name = model.automaton.inputs().name(input);
  if (name == "lock") return "is held";
  if (name == "unlock") return "is not held";
  if (name == "acquire") return "has no unit left";
  if (name == "release") return "has all its units";
  return name == "read" ? "is being read already" : "is full";
}

std::vector<std::string> describe_unreal(const System& system,
                                         const std::vector<std::uint32_t>& models) {
  using Source = ModelInstance::Source;
  std::map<std::string, std::vector<std::string>> names;  // by kind; "": shared variables
  std::map<std::string, std::vector<std::string>> services;
  std::vector<std::string> of_any_depth;
  for (const std::uint32_t index : models) {
    const ModelInstance& model = system.models[index];
    if (model.source == Source::built_in && has_unknown_depth(model.automaton)) {
      of_any_depth.push_back(model.name);
    } else if (model.source == Source::built_in) {
      names[describe_built_in(model)].push_back(model.name);
    }
    if (model.source == Source::variable) names[""].push_back(model.name);
    if (model.source == Source::service) {
      const auto rmw = model.automaton.origin.find("rmw");
      const std::string over = rmw == model.automaton.origin.end() ? "" : ", over " + rmw->second;
      services["of depth " + model.automaton.origin.at("depth") + over].push_back(model.name);
    }
  }
  std::vector<std::string> lines;
  for (const auto& [depth, of_depth] : services) {
    const bool is_one = of_depth.size() == 1;
    lines.push_back(fmt::format("{} {} by the rules of services ({}; all clients get all answers)",
                                join(of_depth), is_one ? "goes" : "go", depth));
  }
  for (const auto& [kind, of_kind] : names) {
    const bool is_one = of_kind.size() == 1;
    lines.push_back(join(of_kind) +
                    (kind.empty() ? is_one ? " is a shared variable" : " are shared variables"
                                  : fmt::format(" {} written by hand ({}{})", is_one ? "is" : "are",
                                                kind, is_one ? "" : " each")));
  }
  if (!of_any_depth.empty()) {
    lines.push_back(fmt::format("{} {} for every depth (depth: unknown)", join(of_any_depth),
                                of_any_depth.size() == 1 ? "stands" : "stand"));
  }
  std::ranges::sort(lines);
  return lines;
}

std::string describe_use(const System& system, const ModelUse& use) {
  const ModelInstance& model = system.models[use.model];
  switch (use.kind) {
    case ModelUse::Kind::give: return model.name + "." + model.automaton.inputs().name(use.index);
    case ModelUse::Kind::take: return model.name + "!" + model.automaton.outputs().name(use.index);
    case ModelUse::Kind::act: return model.actions[use.index].name;
    default: return model.name + " quiet";
  }
}

std::string describe_edge(const System& system, const Program& program, const ProgramEdge& edge) {
  if (edge.kind == ProgramEdge::Kind::combined) return program.combined[edge.index].text;
  if (edge.kind == ProgramEdge::Kind::choice) return edge.index == 0 ? "if *" : "if * ... else";
  return describe_use(system, edge);
}

std::string describe_action(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].what.text;
  return describe_edge(system, system.programs[step.actor], edge_of(system, step));
}

std::string describe_actor(const System& system, const Step& step) {
  return step.actor == nobody ? describe_action(system, step) : actor_name(system, step.actor);
}

std::string describe_error(const System& system, const GlobalState& state) {
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    if (!program.is_error(state.programs[index])) continue;
    const ProgramError& error = program.errors[program.states[state.programs[index]].error];
    return fmt::format("{}: {} ({})", program.name, error.text, to_string(error.position));
  }
  return "";
}

std::string describe_waiting(const System& system, const Program& program,
                             const std::vector<ProgramEdge>& awaited) {
  const bool is_select = std::ranges::any_of(awaited, [&](const ProgramEdge& edge) {
    const CombinedStep::Role role = program.role_of(edge);
    return role == CombinedStep::Role::arm || role == CombinedStep::Role::timer ||
           role == CombinedStep::Role::otherwise || role == CombinedStep::Role::timeout;
  });
  std::vector<std::string> steps;
  for (const ProgramEdge& edge : awaited) {
    const std::string step = describe_edge(system, program, edge);
    if (std::ranges::find(steps, step) == steps.end()) steps.push_back(step);
  }
  return fmt::format("waits at {}{} for {}", program.place_of(awaited.front().line),
                     is_select ? " in a select" : "", join(steps, " or "));
}

std::string describe_taker(const System& system, const GlobalState& state, std::uint32_t program,
                           std::uint32_t service) {
  const ModelInstance& model = system.models[service];
  const std::string& on_its_way = model.state_texts[state.models[service]];
  const auto is_there = [&](const std::string& what) {
    return on_its_way.find(what) != std::string::npos;
  };
  constexpr std::string_view starts = " starts";
  for (const std::string& node : system.programs[program].nodes) {
    const bool is_answered = is_there(" to " + node + " not taken");
    if (!is_answered && !is_there(" of " + node + " not served")) continue;
    const auto serve = model.automaton.inputs().find("serve");
    for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
      const Program& runner = system.programs[index];
      // The edges by which the callback starts that takes the answer, or the request.
      const auto takes_it = [&](const ProgramEdge& edge) {
        if (edge.kind != ProgramEdge::Kind::combined) return false;
        const CombinedStep& combined = runner.combined[edge.index];
        if (is_answered) return combined.text == node + "." + model.name + std::string(starts);
        return combined.text.ends_with(starts) &&
               std::ranges::any_of(combined.events, [&](const ModelUse& event) {
                 return event.kind == ModelUse::Kind::give && event.model == service &&
                        event.index == serve;
               });
      };
      const auto taking = std::ranges::find_if(runner.edges, takes_it);
      if (taking == runner.edges.end()) continue;
      const std::string& text = runner.combined[taking->index].text;
      const auto edges = runner.edges_of(state.programs[index]);
      const bool is_free = std::ranges::any_of(edges, takes_it);
      return fmt::format(". {} {} it, and {}", text.substr(0, text.size() - starts.size()),
                         is_answered ? "takes" : "serves",
                         index == program ? runner.name + " runs that, too"
                         : is_free        ? "has no free thread"
                                          : runner.name + " is busy");
    }
  }
  return "";
}

}  // namespace maide
