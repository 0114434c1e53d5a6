#include "maide/report/trace_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>
#include <vector>

#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

constexpr std::size_t most_listed = 3;  // names that differ in their values alone

// The inputs that the instance takes in its state, or the outputs that are due.
std::string actions_of(const System& system, std::uint32_t index, StateId state,
                       Action::Kind kind) {
  const ModelInstance& model = system.models[index];
  std::vector<std::string> names;
  for (const auto& transition : model.automaton.transitions(state)) {
    if (transition.action.kind != kind || transition.absorbed) continue;
    const Alphabet& alphabet =
        transition.action.is_input() ? model.automaton.inputs() : model.automaton.outputs();
    const std::string& name = alphabet.name(transition.action.symbol);
    names.push_back(file_word(system, index, name));
  }
  return fmt::format("{}", fmt::join(without_values(names, most_listed), ", "));
}

// Why the instance does not do what a program waits for.
std::string describe_model(const System& system, StateId state, const ProgramEdge& edge) {
  const ModelInstance& model = system.models[edge.model];
  if (!model.automaton.is_quiescent(state)) {
    return fmt::format("{} has {} due", model.name,
                       actions_of(system, edge.model, state, Action::Kind::output));
  }
  if (edge.kind == Kind::give) {
    if (is_beyond_learned(model.automaton, state, edge.index)) {
      return describe_bound(model) + ", and there it waits";
    }
    if (model.source == ModelInstance::Source::built_in) {
      return model.name + " " + describe_refusal(model, edge.index);
    }
    return model.name + " does not take it now: an earlier call has not returned";
  }
  const std::string inputs = actions_of(system, edge.model, state, Action::Kind::input);
  return fmt::format("{} has nothing to give{}", model.name,
                     inputs.empty() ? "" : "; it would take " + inputs);
}

void write_waiting(std::ostream& out, const System& system, const GlobalState& state,
                   const Program& program, ControlState control) {
  const std::vector<ProgramEdge> awaited = awaited_at(program, control);
  std::vector<std::string> steps;
  for (const ProgramEdge& edge : awaited) steps.push_back(describe_edge(system, program, edge));
  const std::vector<Program::Guard> guards = closed_guards(program, control);
  if (awaited.empty() && guards.empty()) {
    out << fmt::format("  {} {}\n", program.name,
                       program.may_die() ? "can only die" : "waits for what never comes");
    return;
  }
  const bool is_plain =
      guards.empty() && awaited.front().kind != Kind::act && awaited.front().kind != Kind::combined;
  if (!is_plain) {
    out << fmt::format("  {} {}\n", program.name,
                       describe_waiting(system, program, awaited, guards));
    return;
  }
  const ProgramEdge& first = awaited.front();
  out << fmt::format("  {} waits at {} {}{}; {}\n", program.name, program.place_of(first.line),
                     first.kind == Kind::give ? "to give " : "for ",
                     fmt::join(without_values(steps), " or "),
                     describe_model(system, state.models[first.model], first));
}

// Whether some program waits for one of the outputs that are due.
bool is_awaited(const System& system, const GlobalState& state, std::uint32_t model) {
  const auto steps = enabled_steps(system, state);
  return std::ranges::any_of(steps, [&](const Step& step) {
    const auto events = events_of(system, step);
    return std::ranges::any_of(events, [&](const ModelUse& event) {
      return event.kind == Kind::take && event.model == model;
    });
  });
}

// Who does not step in the loop, and what keeps it from that.
void write_loop(std::ostream& out, const System& system, const Trace& trace,
                const std::vector<GlobalState>& states) {
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState control = states.back().programs[index];
    bool steps = false, is_disabled = false;
    std::size_t where = *trace.loop_start;
    for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
      steps = steps || trace.steps[at].actor == index;
      const auto enabled = enabled_steps(system, states[at]);
      const bool can =
          std::ranges::any_of(enabled, [&](const Step& step) { return step.actor == index; });
      if (!can && !is_disabled) where = at;
      is_disabled = is_disabled || !can;
    }
    if (steps || program.is_end(control) || program.may_rest(control)) continue;
    out << fmt::format("{} never steps again:\n", program.name);
    if (is_disabled) {
      write_waiting(out, system, states[where], program, control);
    } else {
      out << "  it could, but never gets its turn\n";
    }
  }
}

// Who does what where nothing can happen any more.
void write_deadlock(std::ostream& out, const System& system, const GlobalState& state) {
  out << "nothing can happen any more:\n";
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState control = state.programs[index];
    if (program.is_end(control)) {
      out << fmt::format("  {} has ended\n", program.name);
    } else if (program.may_rest(control)) {
      out << fmt::format("  {} rests\n", program.name);
    } else {
      write_waiting(out, system, state, program, control);
    }
  }
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    const ModelInstance& model = system.models[index];
    if (model.automaton.is_quiescent(state.models[index])) continue;
    if (is_awaited(system, state, index)) continue;
    out << fmt::format("  {} has {} due, which no program takes: until then it takes no input\n",
                       model.name,
                       actions_of(system, index, state.models[index], Action::Kind::output));
  }
}

void write_steps(std::ostream& out, const System& system, const Trace& trace,
                 const SequenceChart& chart, const ChartTextStyle& style) {
  std::size_t name_width = 0, place_width = 0, event_width = 0;
  const auto name_of = [&](const Step& step) {
    const std::uint32_t doer = doer_of(system, step);
    return doer == nobody ? "-" : actor_name(system, doer);
  };
  const auto line_of = [&](const Step& step) -> std::string {
    if (const auto origin = origin_of(system, step)) return name_of_place(*origin);
    const SourcePosition place = place_of(system, step);
    if (place.line == 0) return "";
    return name_of_place(place);
  };
  for (const Step& step : trace.steps) {
    name_width = std::max(name_width, name_of(step).size());
    place_width = std::max(place_width, line_of(step).size());
    event_width = std::max(event_width, describe_action(system, step).size());
  }
  bool in_loop = false;
  std::string shown;  // the place whose text was shown last
  for (const ChartRow& row : fold_chart(chart, style.most_rows)) {
    if (!in_loop && chart.loop_start && row.message >= *chart.loop_start) {
      in_loop = true;
      shown.clear();
      out << "  from here on, again and again:\n";
    }
    if (!row.remark.empty()) {
      out << "       ... " << row.remark << " ...\n";
      shown.clear();
      continue;
    }
    const SequenceChart::Message& message = chart.messages[row.message];
    const Step& step = trace.steps[message.step];
    const std::string place = line_of(step);
    std::string line =
        fmt::format("{:>5}  {:<{}}  {:<{}}  {:<{}}  {}", message.step + 1, name_of(step),
                    name_width, place, place_width, describe_action(system, step), event_width,
                    place == shown ? "" : message.source);
    shown = place;
    line.erase(line.find_last_not_of(' ') + 1);
    if (!message.remark.empty()) line += "  (" + message.remark + ")";
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << "\n";
  }
}

}  // namespace

std::string name_of_place(const SourcePosition& place) {
  return fmt::format("{}:{}", std::filesystem::path(place.file).filename().string(), place.line);
}

void write_run_text(std::ostream& out, const System& system, const Trace& trace, TraceFormat format,
                    const ChartTextStyle& style) {
  const SequenceChart chart = make_trace_chart(system, trace, "");
  if (format == TraceFormat::chart && fits_as_text(chart, style)) {
    write_sequence_chart_text(out, chart, style);
  } else {
    write_steps(out, system, trace, chart, style);
  }
}

bool write_standstill(std::ostream& out, const System& system, const GlobalState& state) {
  if (state.is_cut) {
    out << "  here the run leaves what was learned\n";
  } else if (is_error(system, state)) {
    out << "  here the run comes to an error: " << describe_error(system, state) << "\n";
  } else if (has_ended(system, state)) {
    out << "  all programs have ended\n";
  } else if (is_deadlock(system, state)) {
    write_deadlock(out, system, state);
  } else {
    return false;
  }
  return true;
}

void write_trace_text(std::ostream& out, const System& system, const Trace& trace,
                      TraceFormat format, const ChartTextStyle& style) {
  write_run_text(out, system, trace, format, style);
  const std::vector<GlobalState> states = replay(system, trace);
  if (trace.loop_start) {
    write_loop(out, system, trace, states);
  } else if (!write_standstill(out, system, states.back())) {
    out << "  whatever comes now, the property is violated\n";
  }
}

void write_shown_text(std::ostream& out, const Shown& shown, TraceFormat format,
                      const ChartTextStyle& style) {
  const auto write = shown.property.is_possibility ? write_run_text : write_trace_text;
  write(out, shown.part.system(), shown.trace, format, style);
}

namespace {

// The names of programs, and of the nodes whose callbacks they run.
Json program_names(const System& system, const std::vector<std::uint32_t>& programs) {
  Json names = Json::array();
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const std::uint32_t program : programs) {
    const Program& own = system.programs[program];
    if (own.nodes.empty()) add(own.name);
    for (const std::string& node : own.nodes) add(node);
  }
  return names;
}

Json races_to_json(const Races& races) {
  Json pairs = Json::array();
  for (const Race& race : races.all) {
    Json pair{{"later", race.later}, {"earlier", race.earlier}, {"reader", race.reader}};
    if (race.missed) pair["missed"] = {{"file", race.missed->file}, {"line", race.missed->line}};
    pairs.push_back(std::move(pair));
  }
  return {{"pairs", std::move(pairs)},
          {"complete", races.is_complete && !races.has_unknown},
          {"states", races.states}};
}

}  // namespace

Json report_to_json(const System& system, const CheckReport& report) {
  Json components = Json::array();
  for (const CheckReport::Component& component : report.components) {
    Json verdicts = Json::object();
    for (const auto& [property, verdict] : component.verdicts) {
      verdicts[property] = to_string(verdict);
    }
    components.push_back({{"programs", program_names(system, component.programs)},
                          {"states", component.states},
                          {"transitions", component.transitions},
                          {"verdicts", std::move(verdicts)}});
  }
  Json properties = Json::array();
  for (const PropertyResult& result : report.properties) {
    Json entry{{"name", result.name},
               {"verdict", to_string(result.verdict)},
               {"states", result.states},
               {"transitions", result.transitions},
               {"seconds", result.seconds},
               {"peak_bytes", result.peak_bytes},
               {"bytes_per_state", result.bytes_per_state()},
               {"reduction", to_string(result.reduction)}};
    if (!result.reason.empty()) entry["reason"] = result.reason;
    if (result.is_possibility && result.verdict != Verdict::inconclusive) {
      entry["possible"] = result.verdict == Verdict::holds;
    }
    if (result.is_internal_error) entry["internal_error"] = true;
    if (result.trace) {
      const Shown shown = shown_part(system, result);
      entry["explanation"] = explain(shown.part.system(), shown.property, shown.trace);
      if (const PropertyResult* same = find_same_run(report, result)) {
        entry["same_run_as"] = same->name;
      }
    }
    entry["component"] = result.programs.empty() ? Json() : program_names(system, result.programs);
    entry["trace"] = result.trace ? trace_to_json(system, *result.trace) : Json::array();
    if (result.trace) {
      entry["loop_start"] = result.trace->loop_start ? Json(*result.trace->loop_start) : Json();
    }
    properties.push_back(std::move(entry));
  }
  Json json{{"verdict", to_string(report.verdict)}};
  for (const auto& [name, value] : system.settings) json["set"][name] = value;
  json["assumptions"] = report.assumptions;
  json["doubts"] = report.doubts;
  json["remarks"] = all_remarks(system, report);
  json["components"] = std::move(components);
  json["properties"] = std::move(properties);
  if (report.races) json["races"] = races_to_json(*report.races);
  return json;
}

}  // namespace maide
