#include "maide/report/simulation_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/check/verdict/on_its_way.hpp"
#include "maide/check/verdict/waiting.hpp"
#include "maide/report/explanation.hpp"

namespace maide {
namespace {

std::string line_of(const System& system, const Step& step) {
  const int line = place_of(system, step).line;
  return line == 0 ? "" : fmt::format("line {}", line);
}

// The text of its line.
std::string source_of(const System& system, const Step& step) {
  if (doer_of(system, step) == nobody) return "";
  return source_line(system, system.programs[step.actor], place_of(system, step).line);
}

// What is worth knowing of a step before it is taken.
std::string remark_on(const System& system, const Step& step) {
  if (step.is_cut) return "never tried there: the run is cut";
  if (step.is_beyond) return "never tried there: dropped";
  if (const std::string lost = lost_by(system, step); !lost.empty()) return lost + " is lost";
  return "";
}

// The outputs that are due, in the file's words.
std::string describe_due(const System& system, std::uint32_t model, StateId state) {
  const InterfaceAutomaton& automaton = system.models[model].automaton;
  std::vector<std::string> names;
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action.is_input() || transition.absorbed) continue;
    names.push_back(file_word(system, model, automaton.outputs().name(transition.action.symbol)));
  }
  return join(names, " or ");
}

// "3 messages: message(1), ..."; without the list where no message has a value.
std::string describe_messages(const System& system, std::uint32_t model,
                              const std::vector<Symbol>& held) {
  constexpr std::size_t most_shown = 12;
  const Alphabet& outputs = system.models[model].automaton.outputs();
  const std::string count = held.empty() ? "no message" : counted(held.size(), "message");
  std::vector<std::string> names;
  bool has_values = false;
  for (const Symbol output : held) {
    has_values = has_values || outputs.name(output) != "message";
    if (names.size() == most_shown) {
      names.emplace_back("...");
      break;
    }
    names.push_back(file_word(system, model, outputs.name(output)));
  }
  return has_values ? count + ": " + join(names) : count;
}

// The inputs that the built-in model refuses there, each as a fact: "is held", "is full".
std::string describe_refusals(const ModelInstance& model, StateId state) {
  std::vector<std::string> facts;
  for (Symbol input = 0; input < model.automaton.inputs().size(); ++input) {
    const auto transitions = model.automaton.transitions(state);
    const bool takes = std::ranges::any_of(transitions, [&](const auto& way) {
      return way.action == Action{Action::Kind::input, input};
    });
    if (!takes) facts.push_back(describe_refusal(model, input));
  }
  std::ranges::sort(facts);
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return join(facts, ", ");
}

// What the model holds; "" of one that is not shown.
std::string describe_model(const System& system, std::uint32_t index, StateId state) {
  using Source = ModelInstance::Source;
  const ModelInstance& model = system.models[index];
  switch (model.source) {
    case Source::executor:
    case Source::anybody: return "";
    case Source::variable:
      return model.name + " = " + to_string(model.type.at(state), model.type.kind, system.words);
    case Source::service:
    case Source::wire: {
      const bool is_known = state < model.state_texts.size();
      const std::string text = is_known ? model.state_texts[state] : "what was not explored";
      return model.name + " holds " + (text.empty() ? "nothing" : text);
    }
    case Source::file:
    case Source::built_in: break;
  }
  std::vector<std::string> facts;
  if (const auto held = find_held(system, index, state)) {
    facts.push_back("holds " + describe_messages(system, index, *held));
  }
  if (!model.automaton.is_quiescent(state)) {
    facts.push_back("has " + describe_due(system, index, state) + " due");
  } else if (model.source == Source::built_in) {
    const std::string refusals = describe_refusals(model, state);
    if (!refusals.empty()) facts.push_back(refusals);
  }
  if (facts.empty()) facts.emplace_back("is at rest");
  return model.name + " " + join(facts, ", ");
}

std::string describe_values(const System& system, const Program& program, ControlState at) {
  std::vector<std::string> values;
  for (std::uint32_t index = 0; index < program.variables.size(); ++index) {
    const ProgramVariable& variable = program.variables[index];
    const auto value = program.value_of(at, index);
    if (!value) continue;
    values.push_back(variable.name + " = " + to_string(*value, variable.type.kind, system.words));
  }
  return values.empty() ? "" : " (" + join(values) + ")";
}

std::string describe_program(const Simulation& simulation, std::uint32_t index) {
  const System& system = simulation.system();
  const Program& program = system.programs[index];
  const GlobalState& state = simulation.states().back();
  const ControlState at = state.programs[index];
  const auto blocked = blocked_programs(system, state);
  const bool can_step =
      std::ranges::any_of(simulation.next(), [&](const Step& step) { return step.actor == index; });
  std::string text = program.name + " can go on";
  if (program.is_error(at)) {
    text = program.name + " is at an error: " + program.errors[program.states[at].error].text;
  } else if (program.is_end(at)) {
    text = program.name + " has ended";
  } else if (std::ranges::find(blocked, index) != blocked.end()) {
    text = explain_waiting(system, simulation.trace(), index);
  } else if (!can_step) {
    text = program.name + (program.may_rest(at) ? " rests" : " cannot go on");
  }
  return text + describe_values(system, program, at);
}

std::string sentence_of(const Simulation& simulation, const char* property) {
  return explain(simulation.system(), find_property(simulation.system(), property),
                 simulation.trace());
}

}  // namespace

std::string describe_choices(const Simulation& simulation, std::size_t width) {
  const System& system = simulation.system();
  std::size_t actor_width = 0, line_width = 0, action_width = 0;
  std::map<std::string, int> times;  // how often steps look so
  const auto look = [&](const Step& step) {
    return actor_name(system, step.actor) + " " + line_of(system, step) + " " +
           describe_action(system, step);
  };
  for (const Step& step : simulation.next()) {
    actor_width = std::max(actor_width, actor_name(system, step.actor).size());
    line_width = std::max(line_width, line_of(system, step).size());
    action_width = std::max(action_width, describe_action(system, step).size());
    ++times[look(step)];
  }
  std::map<std::string, int> shown;
  std::string text;
  for (std::size_t at = 0; at < simulation.next().size(); ++at) {
    const Step& step = simulation.next()[at];
    std::string line = fmt::format(
        "{:>4}  {:<{}}  {:<{}}  {:<{}}", at + 1, actor_name(system, step.actor), actor_width,
        line_of(system, step), line_width, describe_action(system, step), action_width);
    const std::string source = source_of(system, step);
    if (line.size() + 2 + source.size() <= width) line += "  " + source;
    line.erase(line.find_last_not_of(' ') + 1);
    const std::string remark = remark_on(system, step);
    if (!remark.empty()) line += "  (" + remark + ")";
    if (const int ways = times[look(step)]; ways > 1) {
      line += fmt::format("  (way {} of {} that a model may go)", ++shown[look(step)], ways);
    }
    text += line + "\n";
  }
  return text;
}

std::string describe_last_step(const Simulation& simulation) {
  const System& system = simulation.system();
  const Step& step = simulation.trace().steps.back();
  const std::string line = line_of(system, step);
  return fmt::format("step {}: {} {}{}", simulation.trace().steps.size(),
                     actor_name(system, step.actor), describe_action(system, step),
                     line.empty() ? "" : " (" + line + ")");
}

std::string describe_situation(const Simulation& simulation) {
  const System& system = simulation.system();
  const GlobalState& state = simulation.states().back();
  std::string text;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    text += "  " + describe_program(simulation, index) + "\n";
  }
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    const std::string model = describe_model(system, index, state.models[index]);
    if (!model.empty()) text += "  " + model + "\n";
  }
  return text;
}

std::string explain_end(const Simulation& simulation) {
  switch (simulation.end()) {
    case Simulation::End::none: return "";
    case Simulation::End::ended: return "all programs have ended";
    case Simulation::End::at_rest:
      return "nothing can happen any more, and who has not ended may rest";
    case Simulation::End::deadlock: return "a deadlock: " + sentence_of(simulation, "deadlock");
    case Simulation::End::error: return "an error: " + sentence_of(simulation, "error");
    case Simulation::End::cut: return "here the run leaves what was learned";
  }
  return "";
}

std::string_view to_string(Simulation::End end) {
  switch (end) {
    case Simulation::End::none: return "";
    case Simulation::End::ended: return "ended";
    case Simulation::End::at_rest: return "at rest";
    case Simulation::End::deadlock: return "deadlock";
    case Simulation::End::error: return "error";
    case Simulation::End::cut: return "cut";
  }
  return "";
}

}  // namespace maide
