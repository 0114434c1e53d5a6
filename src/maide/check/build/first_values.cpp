#include "maide/check/build/first_values.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "maide/check/rules/thread_models.hpp"
#include "maide/check/system/components.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {
namespace {

constexpr std::size_t most_combinations = 4096;

// All steps of the program's first control state wait for the gate, and change nothing of it.
void wait_at_first(System& system, std::uint32_t number, const ModelUse& gate) {
  Program& program = system.programs[number];
  const Program::State first = program.states.front();
  for (std::uint32_t i = 0; i < first.edge_count; ++i) {
    ProgramEdge& edge = program.edges[first.first_edge + i];
    if (edge.kind != ModelUse::Kind::combined) {
      CombinedStep step = as_combined_step(
          edge, edge.kind == ModelUse::Kind::choice ? nullptr : &system.models[edge.model]);
      edge.kind = ModelUse::Kind::combined;
      edge.model = 0;
      edge.index = static_cast<std::uint32_t>(program.combined.size());
      program.combined.push_back(std::move(step));
    }
    std::vector<ModelUse>& uses = program.combined[edge.index].uses;
    uses.push_back(gate);
    std::ranges::sort(uses, {}, &ModelUse::model);
  }
  program.names.insert(std::ranges::lower_bound(program.names, gate.model), gate.model);
}

void choose_in_component(System& system, const std::vector<std::uint32_t>& component,
                         const std::vector<std::uint32_t>& variables, const std::string& name) {
  const auto gate = static_cast<std::uint32_t>(system.models.size());
  ModelInstance model;
  model.name = name;
  model.source = ModelInstance::Source::executor;
  model.automaton = make_gate();
  model.position = system.models[variables.front()].position;
  system.models.push_back(std::move(model));
  for (const std::uint32_t program : component) {
    wait_at_first(system, program, {ModelUse::Kind::give, gate, gate_input_pass});
  }
  Program chooser;
  chooser.name = name;
  chooser.position = system.models[gate].position;
  chooser.process = "one of " + name;
  chooser.last_line = chooser.position.line;
  chooser.label_sets.emplace_back();
  chooser.rounds.emplace_back();
  chooser.valuations.emplace_back();
  chooser.errors.emplace_back();
  chooser.fair_groups.emplace_back();
  chooser.states.resize(2);
  ModelActions actions(system);
  std::vector<CombinedStep> ways(1);
  for (const std::uint32_t variable : variables) {
    const ValueType type = system.models[variable].type;
    if (ways.size() * type.count() > most_combinations) {
      throw ParseError("variables that have any value at first have more than " +
                           std::to_string(most_combinations) + " values together",
                       system.models[variable].position);
    }
    std::vector<CombinedStep> next;
    for (const CombinedStep& way : ways) {
      for (std::uint64_t number = 0; number < type.count(); ++number) {
        CombinedStep more = way;
        const Value value = type.at(number);
        more.uses.push_back(actions.variable(variable, nullptr, value));
        more.text += (more.text.empty() ? "" : ", ") + system.models[variable].name + " = " +
                     to_string(value, type.kind, system.words);
        next.push_back(std::move(more));
      }
    }
    ways = std::move(next);
  }
  for (CombinedStep& way : ways) {
    way.role = CombinedStep::Role::choice;
    way.uses.push_back({ModelUse::Kind::give, gate, gate_input_open});
    std::ranges::sort(way.uses, {}, &ModelUse::model);
    ProgramEdge edge;
    edge.kind = ModelUse::Kind::combined;
    edge.index = static_cast<std::uint32_t>(chooser.combined.size());
    edge.target = 1;
    edge.line = chooser.position.line;
    edge.column = chooser.position.column;
    chooser.edges.push_back(edge);
    chooser.combined.push_back(std::move(way));
  }
  chooser.states[0].edge_count = static_cast<std::uint32_t>(chooser.edges.size());
  chooser.states[1].first_edge = chooser.states[0].edge_count;
  chooser.names = variables;
  chooser.names.push_back(gate);
  system.programs.push_back(std::move(chooser));
}

}  // namespace

void choose_first_values(System& system, const std::vector<std::uint32_t>& variables) {
  std::uint32_t count = 0;
  for (const std::vector<std::uint32_t>& component : find_components(system)) {
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t variable : variables) {
      const bool is_used = std::ranges::any_of(component, [&](std::uint32_t program) {
        return models_of(system.programs[program]).contains(variable);
      });
      if (is_used) chosen.push_back(variable);
    }
    if (chosen.empty()) continue;
    const std::string number = ++count == 1 ? "" : " " + std::to_string(count);
    choose_in_component(system, component, chosen, "first values" + number);
  }
}

}  // namespace maide
