#include "flat_promela.hpp"

#include <fmt/format.h>

#include <map>
#include <stdexcept>

namespace maide::bench {
namespace {

// What an edge does to its model: the state afterwards, by the state before.
std::map<StateId, StateId> moves(const ModelInstance& model, const ProgramEdge& edge) {
  std::map<StateId, StateId> result;
  const InterfaceAutomaton& automaton = model.automaton;
  const bool gives = edge.kind == ProgramEdge::Kind::give;
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (gives && !automaton.is_quiescent(state)) continue;
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.action.is_input() != gives || transition.action.symbol != edge.index) continue;
      if (transition.absorbed) continue;
      if (!result.emplace(state, transition.target).second) {
        throw std::logic_error("a nondeterministic model in a benchmark");
      }
    }
    if (!gives || !is_beyond_learned(automaton, state, edge.index)) continue;
    if (model.when_unexplored == WhenUnexplored::stop) {
      throw std::logic_error("a run that is cut in a benchmark");
    }
    if (model.when_unexplored == WhenUnexplored::drop) result.emplace(state, state);
  }
  return result;
}

std::string statement(const System& system, const ProgramEdge& edge) {
  if (edge.kind == ProgramEdge::Kind::choice) return "(_pid >= 0)";
  const std::string model = fmt::format("model{}", edge.model);
  const ModelInstance& instance = system.models[edge.model];
  if (edge.kind == ProgramEdge::Kind::quiet) {
    std::string condition;
    for (StateId state = 0; state < instance.automaton.size(); ++state) {
      if (!instance.automaton.is_quiescent(state)) continue;
      condition += fmt::format("{}{} == {}", condition.empty() ? "" : " || ", model, state);
    }
    return "(" + condition + ")";
  }
  std::string text = "d_step { if";
  for (const auto& [from, to] : moves(instance, edge)) {
    text += fmt::format(" :: {0} == {1} -> {0} = {2}", model, from, to);
  }
  return text + " fi }";
}

}  // namespace

std::string write_flat_promela(const System& system) {
  std::string text;
  for (std::size_t index = 0; index < system.models.size(); ++index) {
    const InterfaceAutomaton& automaton = system.models[index].automaton;
    if (automaton.size() > 256) throw std::logic_error("a large model in a benchmark");
    text += fmt::format("byte model{} = {};\n", index, automaton.initial());
  }
  const auto label = [](const Program& program, ControlState state) {
    return fmt::format("{}s{}", program.is_end(state) ? "end_" : "", state);
  };
  for (const Program& program : system.programs) {
    text += fmt::format("active proctype program_{}() {{\n", program.name);
    for (ControlState state = 0; state < program.states.size(); ++state) {
      text += label(program, state) + (program.is_end(state) ? ": false;\n" : ": if\n");
      if (program.is_end(state)) continue;
      for (const ProgramEdge& edge : program.edges_of(state)) {
        text += fmt::format("  :: {} -> goto {}\n", statement(system, edge),
                            label(program, edge.target));
      }
      text += "  fi;\n";
    }
    text += "}\n";
  }
  return text;
}

}  // namespace maide::bench
