#include "maide/report/trace_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "maide/check/trace_file.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

// The inputs that the instance takes in its state, or the outputs that are due.
std::string actions_of(const ModelInstance& model, StateId state, Action::Kind kind) {
  std::vector<std::string> names;
  for (const auto& transition : model.automaton.transitions(state)) {
    if (transition.action.kind != kind || transition.absorbed) continue;
    const Alphabet& alphabet =
        transition.action.is_input() ? model.automaton.inputs() : model.automaton.outputs();
    const std::string& name = alphabet.name(transition.action.symbol);
    if (names.empty() || names.back() != name) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

// Why the instance does not do what a program waits for.
std::string describe_model(const ModelInstance& model, StateId state, const ProgramEdge& edge) {
  if (!model.automaton.is_quiescent(state)) {
    return fmt::format("{} has {} due", model.name, actions_of(model, state, Action::Kind::output));
  }
  if (edge.kind == Kind::give) {
    if (is_beyond_learned(model.automaton, state, edge.symbol)) {
      return describe_bound(model) + ", and there it waits";
    }
    return model.name + " does not take it now: an earlier call has not returned";
  }
  const std::string inputs = actions_of(model, state, Action::Kind::input);
  return fmt::format("{} has nothing to give{}", model.name,
                     inputs.empty() ? "" : "; it would take " + inputs);
}

void write_waiting(std::ostream& out, const System& system, const GlobalState& state,
                   const Program& program, ControlState control) {
  const auto edges = program.edges_of(control);
  std::vector<std::string> awaited;
  for (const ProgramEdge& edge : edges) awaited.push_back(describe_edge(system, edge));
  const ProgramEdge& first = edges.front();
  out << fmt::format("  {} waits at line {} {}{}; {}\n", program.name, first.line,
                     first.kind == Kind::give ? "to give " : "for ", fmt::join(awaited, " or "),
                     describe_model(system.models[first.model], state.models[first.model], first));
}

// Whether some program waits for one of the outputs that are due.
bool is_awaited(const System& system, const GlobalState& state, std::uint32_t model) {
  const auto steps = enabled_steps(system, state);
  return std::any_of(steps.begin(), steps.end(), [&](const Step& step) {
    const ProgramEdge& edge = system.programs[step.program].edges[step.edge];
    return edge.kind == Kind::take && edge.model == model;
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
      steps = steps || trace.steps[at].program == index;
      const auto enabled = enabled_steps(system, states[at]);
      const bool can = std::any_of(enabled.begin(), enabled.end(),
                                   [&](const Step& step) { return step.program == index; });
      if (!can && !is_disabled) where = at;
      is_disabled = is_disabled || !can;
    }
    if (steps || program.is_end(control)) continue;
    out << fmt::format("{} never steps again:\n", program.name);
    if (is_disabled) {
      write_waiting(out, system, states[where], program, control);
    } else {
      out << "  it could, but never gets its turn\n";
    }
  }
}

void write_end(std::ostream& out, const System& system, const Trace& trace,
               const std::vector<GlobalState>& states) {
  if (trace.loop_start) {
    write_loop(out, system, trace, states);
    return;
  }
  const GlobalState& state = states.back();
  if (state.is_cut) {
    out << "  here the run leaves what was learned\n";
    return;
  }
  if (has_ended(system, state)) {
    out << "  all programs have ended\n";
    return;
  }
  if (!is_deadlock(system, state)) {
    out << "  whatever comes now, the property is violated\n";
    return;
  }
  out << "nothing can happen any more:\n";
  for (std::size_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState control = state.programs[index];
    if (program.is_end(control)) {
      out << fmt::format("  {} has ended\n", program.name);
    } else {
      write_waiting(out, system, state, program, control);
    }
  }
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    const ModelInstance& model = system.models[index];
    if (model.automaton.is_quiescent(state.models[index])) continue;
    if (is_awaited(system, state, index)) continue;
    out << fmt::format("  {} has {} due, which no program takes: until then it takes no input\n",
                       model.name, actions_of(model, state.models[index], Action::Kind::output));
  }
}

}  // namespace

void write_trace_text(std::ostream& out, const System& system, const Trace& trace,
                      std::size_t most_steps) {
  const std::vector<GlobalState> states = replay(system, trace);
  std::size_t name_width = 0;
  for (const Program& program : system.programs) {
    name_width = std::max(name_width, program.name.size());
  }
  const std::size_t count = trace.steps.size();
  const std::size_t head = count > most_steps ? most_steps / 2 : count;
  const std::size_t tail = count > most_steps ? count - (most_steps - head) : count;
  for (std::size_t at = 0; at < count; ++at) {
    if (trace.loop_start == at) out << "  from here on, again and again:\n";
    if (at == head && tail > head) out << fmt::format("  ... {} steps ...\n", tail - head);
    if (at >= head && at < tail) continue;
    const Program& program = system.programs[trace.steps[at].program];
    const ProgramEdge& edge = program.edges[trace.steps[at].edge];
    const bool is_dropped = trace.steps[at].is_beyond &&
                            system.models[edge.model].when_unexplored == WhenUnexplored::drop;
    out << fmt::format("{:>5}  {:<{}}  line {:<4} {}{}\n", at + 1, program.name, name_width,
                       edge.line, describe_edge(system, edge),
                       is_dropped ? "  (never tried there: dropped)" : "");
  }
  write_end(out, system, trace, states);
}

Json trace_to_json(const System& system, const Trace& trace) {
  Json steps = Json::array();
  for (const Step& step : trace.steps) {
    const StepText text = describe_step(system, step);
    steps.push_back({{"program", text.program},
                     {"line", text.line},
                     {"model", text.model.empty() ? Json() : Json(text.model)},
                     {"event", text.event}});
  }
  return steps;
}

Json report_to_json(const System& system, const CheckReport& report) {
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
    entry["trace"] = result.trace ? trace_to_json(system, *result.trace) : Json::array();
    if (result.trace && result.trace->loop_start) entry["loop_start"] = *result.trace->loop_start;
    properties.push_back(std::move(entry));
  }
  return {{"verdict", to_string(report.verdict)},
          {"assumptions", report.assumptions},
          {"properties", std::move(properties)}};
}

}  // namespace maide
