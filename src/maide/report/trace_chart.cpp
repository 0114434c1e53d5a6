#include "maide/report/trace_chart.hpp"

#include <fmt/format.h>

#include <utility>

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

// Where the lanes of programs and models are.
struct Lanes {
  explicit Lanes(const System& system) : models(system.models.size()) {}
  std::size_t of_program(std::size_t program) const { return program == 0 ? 0 : models + program; }
  static std::size_t of_model(std::size_t model) { return 1 + model; }
  std::size_t models;
};

SequenceChart::Message to_message(const System& system, const Lanes& lanes, const Step& step) {
  const ProgramEdge& edge = system.programs[step.program].edges[step.edge];
  const std::size_t program = lanes.of_program(step.program);
  SequenceChart::Message message{program, program, "", fmt::format("line {}", edge.line)};
  if (edge.kind == Kind::choice) {
    message.label = edge.symbol == 0 ? "if" : "else";
    return message;
  }
  const ModelInstance& model = system.models[edge.model];
  const std::size_t lane = Lanes::of_model(edge.model);
  switch (edge.kind) {
    case Kind::give:
      message.to = lane;
      message.label = model.automaton.inputs().name(edge.symbol);
      if (step.is_beyond) message.label += " (never tried)";
      break;
    case Kind::take:
      message.from = lane;
      message.label = model.automaton.outputs().name(edge.symbol);
      break;
    default: message.label = model.name + " is quiet"; break;
  }
  return message;
}

// What a program that has not ended waits for: the first of it.
std::string describe_wait(const System& system, const ProgramEdge& edge) {
  if (edge.kind == Kind::choice) return "can go on";
  const ModelInstance& model = system.models[edge.model];
  switch (edge.kind) {
    case Kind::give:
      return fmt::format("waits: {}.{}", model.name, model.automaton.inputs().name(edge.symbol));
    case Kind::take:
      return fmt::format("waits: {}!{}", model.name, model.automaton.outputs().name(edge.symbol));
    default: return fmt::format("waits: {} quiet", model.name);
  }
}

}  // namespace

SequenceChart make_trace_chart(const System& system, const Trace& trace, std::string title) {
  const Lanes lanes(system);
  SequenceChart chart;
  chart.title = std::move(title);
  chart.loop_start = trace.loop_start;
  chart.lanes.resize(system.programs.size() + system.models.size());
  for (std::size_t i = 0; i < system.programs.size(); ++i) {
    chart.lanes[lanes.of_program(i)] = {system.programs[i].name, false};
  }
  for (std::size_t i = 0; i < system.models.size(); ++i) {
    chart.lanes[Lanes::of_model(i)] = {system.models[i].name, true};
  }
  for (const Step& step : trace.steps) chart.messages.push_back(to_message(system, lanes, step));
  const GlobalState last = replay(system, trace).back();
  if (trace.loop_start || last.is_cut) return chart;
  for (std::size_t i = 0; i < system.programs.size(); ++i) {
    const Program& program = system.programs[i];
    const ControlState control = last.programs[i];
    chart.notes.push_back(
        {lanes.of_program(i), program.is_end(control)
                                  ? "has ended"
                                  : describe_wait(system, program.edges_of(control).front())});
  }
  return chart;
}

}  // namespace maide
