#include "maide/check/rules/model_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

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
    const bool is_recursive = automaton.origin.contains("recursive");
    if (known->option.empty()) {
      return fmt::format("a {}{}", is_recursive ? "recursive " : "", known->name);
    }
    return fmt::format("a {} of {} {}", known->name, known->option,
                       automaton.origin.at(std::string(known->option)));
  }
  if (model.origin == "condition") return "a condition";
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

namespace {

// The setting of one end in a description such as "cyclonedds pub-reliability=both
// reliability=reliable"; "" if the description does not say.
std::string setting_of(const std::string& sul, const std::string& end, const std::string& key) {
  const auto value = [&](const std::string& whole_key) -> std::string {
    for (const std::string_view word : split(sul, ' ')) {
      if (word.starts_with(whole_key + "=")) return std::string(word.substr(whole_key.size() + 1));
    }
    return "";
  };
  const std::string own = value(end + "-" + key);
  return own.empty() || own == "both" ? value(key) : own;
}

bool delivers(const InterfaceAutomaton& automaton) {
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.action.is_input()) continue;
      const std::string& name = automaton.outputs().name(transition.action.symbol);
      if (name.starts_with("message") || name == "next" || name == "gap") return true;
    }
  }
  return false;
}

}  // namespace

std::string describe_mismatch(const ModelInstance& model) {
  const auto sul = model.automaton.origin.find("sul");
  if (sul == model.automaton.origin.end() || delivers(model.automaton)) return "";
  const std::map<std::string, std::vector<std::string>> by_strength{
      {"durability", {"volatile", "transient_local", "transient", "persistent"}},
      {"reliability", {"best_effort", "reliable"}}};
  for (const auto& [key, strengths] : by_strength) {
    const std::string offered = setting_of(sul->second, "pub", key);
    const std::string asked = setting_of(sul->second, "sub", key);
    const auto is_offered = std::ranges::find(strengths, offered);
    const auto is_asked = std::ranges::find(strengths, asked);
    if (is_offered == strengths.end() || is_asked == strengths.end()) continue;
    if (is_offered >= is_asked) continue;
    return fmt::format("its writer offers {} {}, its reader asks for {}, and such ends never match",
                       key, offered, asked);
  }
  return "";
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

namespace {

// "write" of "write2(3)" if the name's word ends with a number; else nothing.
std::optional<std::string> without_number(const std::string& name) {
  const std::size_t end = std::min(name.find('('), name.size());
  const std::size_t last = name.find_last_not_of("0123456789", end == 0 ? 0 : end - 1);
  if (last == std::string::npos || last + 1 == end) return std::nullopt;
  return name.substr(0, last + 1) + name.substr(end);
}

bool has_several_writers(const System& system, std::uint32_t model) {
  return std::ranges::any_of(system.topics, [&](const TopicInstance& topic) {
    return topic.writer_names.size() > 1 &&
           std::ranges::any_of(topic.readers,
                               [&](const auto& reader) { return reader.model == model; });
  });
}

}  // namespace

std::string file_word(const System& system, std::uint32_t model, const std::string& name) {
  const ModelInstance& instance = system.models[model];
  const auto base = without_number(name);
  if (!base) return name;
  if (instance.source == ModelInstance::Source::service) return *base;
  const bool is_known = instance.automaton.inputs().find(*base).has_value() ||
                        instance.automaton.outputs().find(*base).has_value();
  return is_known && has_several_writers(system, model) ? *base : name;
}

std::vector<std::string> without_values(const std::vector<std::string>& names, std::size_t most) {
  const auto base_of = [](std::string name) {
    for (std::size_t open = name.find('('); open != std::string::npos; open = name.find('(')) {
      const std::size_t close = name.find(')', open);
      name.erase(open, close == std::string::npos ? close : close + 1 - open);
    }
    return name;
  };
  std::map<std::string, std::size_t> counts;
  for (const std::string& name : names) ++counts[base_of(name)];
  std::vector<std::string> result;
  for (const std::string& name : names) {
    const std::string base = base_of(name);
    const std::string& shown = counts[base] > most ? base : name;
    if (std::ranges::find(result, shown) == result.end()) result.push_back(shown);
  }
  return result;
}

std::string describe_use(const System& system, const ModelUse& use) {
  const ModelInstance& model = system.models[use.model];
  const auto word = [&](const Alphabet& names) {
    return file_word(system, use.model, names.name(use.index));
  };
  switch (use.kind) {
    case ModelUse::Kind::give: return model.name + "." + word(model.automaton.inputs());
    case ModelUse::Kind::take: return model.name + "!" + word(model.automaton.outputs());
    case ModelUse::Kind::act: return model.actions[use.index].name;
    default: return model.name + " quiet";
  }
}

std::string describe_edge(const System& system, const Program& program, const ProgramEdge& edge) {
  if (edge.kind == ProgramEdge::Kind::choice) return edge.index == 0 ? "if *" : "if * ... else";
  if (edge.kind != ProgramEdge::Kind::combined) return describe_use(system, edge);
  const CombinedStep& combined = program.combined[edge.index];
  std::string text = combined.text;
  for (const ModelUse& event : combined.events) {
    const InterfaceAutomaton& automaton = system.models[event.model].automaton;
    const bool gives = event.kind == ModelUse::Kind::give;
    const std::string& name = (gives ? automaton.inputs() : automaton.outputs()).name(event.index);
    const std::string word = file_word(system, event.model, name);
    if (word == name) continue;
    for (const std::string before : {".", "!", "-> "}) {
      const std::size_t at = text.find(before + name);
      if (at != std::string::npos) text.replace(at + before.size(), name.size(), word);
    }
  }
  return text;
}

std::string describe_action(const System& system, const Step& step) {
  if (step.actor == nobody) return system.nobodys_actions[step.action].what.text;
  return describe_edge(system, system.programs[step.actor], edge_of(system, step));
}

std::string describe_actor(const System& system, const Step& step) {
  const std::uint32_t doer = doer_of(system, step);
  return doer == nobody ? describe_action(system, step) : actor_name(system, doer);
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

std::vector<ProgramEdge> awaited_at(const Program& program, ControlState control) {
  std::vector<ProgramEdge> awaited;
  for (const ProgramEdge& edge : program.edges_of(control)) {
    if (program.is_progress(edge)) awaited.push_back(edge);
  }
  const auto is_error = [&](const ProgramEdge& edge) { return program.is_error(edge.target); };
  if (!std::ranges::all_of(awaited, is_error)) std::erase_if(awaited, is_error);
  return awaited;
}

std::string describe_waiting(const System& system, const Program& program,
                             const std::vector<ProgramEdge>& awaited,
                             const std::vector<Program::Guard>& guards) {
  const bool is_select =
      !guards.empty() || std::ranges::any_of(awaited, [&](const ProgramEdge& edge) {
        const CombinedStep::Role role = program.role_of(edge);
        return role == CombinedStep::Role::arm || role == CombinedStep::Role::timer ||
               role == CombinedStep::Role::otherwise || role == CombinedStep::Role::timeout;
      });
  std::map<std::pair<int, int>, std::vector<std::string>> steps;  // by the place of the arm
  for (const ProgramEdge& edge : awaited) {
    steps[{edge.line, edge.column}].push_back(describe_edge(system, program, edge));
  }
  for (const Program::Guard& guard : guards) {
    steps[{guard.line, guard.column}].push_back(guard.text);
  }
  std::vector<std::string> shown;
  for (const auto& [place, of_arm] : steps) {
    for (const std::string& step : without_values(of_arm)) {
      if (std::ranges::find(shown, step) == shown.end()) shown.push_back(step);
    }
  }
  const int line = awaited.empty() ? guards.front().line : awaited.front().line;
  return fmt::format("waits at {}{} for {}", program.place_of(line),
                     is_select ? " in a select" : "", join(shown, " or "));
}

std::vector<Program::Guard> closed_guards(const Program& program, ControlState control) {
  const auto guards = program.guards_at(control);
  const auto edges = program.edges_of(control);
  std::vector<Program::Guard> closed;
  std::ranges::copy_if(guards, std::back_inserter(closed), [&](const Program::Guard& guard) {
    return std::ranges::none_of(edges, [&](const ProgramEdge& edge) {
      return edge.line == guard.line && edge.column == guard.column;
    });
  });
  return closed;
}

}  // namespace maide
