#include "joint_systems.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "maide/check/rules/model_words.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide::test {
namespace {

using Kind = ModelUse::Kind;

ModelInstance shared_variable(Random& random) {
  const StateId most = static_cast<StateId>(random.between(1, 2));
  ModelInstance model;
  model.name = "v";
  model.source = ModelInstance::Source::variable;
  model.type.high = most;
  model.automaton = InterfaceAutomaton(Alphabet({"none"}), Alphabet({"none"}), most + 1);
  for (StateId value = 0; value <= most; ++value) {
    ModelAction is{fmt::format("v == {}", value), {}}, set{fmt::format("v = {}", value), {}};
    is.steps.resize(most + 1);
    set.steps.resize(most + 1, {{value, false}});
    is.steps[value].push_back({value, false});
    model.actions.push_back(std::move(is));
    model.actions.push_back(std::move(set));
  }
  ModelAction any{"v = any", {}};
  any.steps.resize(most + 1, {{0, false}, {1, false}});
  model.actions.push_back(std::move(any));
  return model;
}

// An input with the output that follows at once, as an arm of a `select` has it.
ModelAction input_with_output(const ModelInstance& model, Symbol input, Symbol output) {
  ModelAction action{model.name + "." + model.automaton.inputs().name(input) + " -> " +
                         model.automaton.outputs().name(output),
                     {}};
  action.steps.resize(model.automaton.size());
  for (StateId at = 0; at < model.automaton.size(); ++at) {
    for (const ModelStep& given : model_steps(model, at, {Kind::give, 0, input})) {
      if (given.is_beyond) {
        action.steps[at].push_back(given);
        continue;
      }
      for (const ModelStep& taken : model_steps(model, given.target, {Kind::take, 0, output})) {
        action.steps[at].push_back(taken);
      }
    }
  }
  return action;
}

ModelUse random_use(const System& system, std::uint32_t index, Random& random) {
  const ModelInstance& model = system.models[index];
  const auto below = [&](std::size_t count) { return static_cast<Symbol>(random.below(count)); };
  if (model.source == ModelInstance::Source::variable) {
    return {Kind::act, index, below(model.actions.size())};
  }
  switch (random.below(model.actions.empty() ? 3 : 4)) {
    case 0: return {Kind::take, index, below(model.automaton.outputs().size())};
    case 1: return {Kind::quiet, index, 0};
    case 2: return {Kind::give, index, below(model.automaton.inputs().size())};
    default: return {Kind::act, index, below(model.actions.size())};
  }
}

class Editor {
 public:
  Editor(System& system, Program& program, const JointSystemKinds& kinds, Random& random)
      : system_(system), program_(program), kinds_(kinds), random_(random) {
    for (const Program::State& state : program.states) {
      edges_.emplace_back(program.edges.begin() + state.first_edge,
                          program.edges.begin() + state.first_edge + state.edge_count);
    }
    program.errors.resize(1);
    program.fair_groups.resize(4);
    for (FairGroup& group : program.fair_groups) group.on_weak_runs = random.chance(0.5);
  }

  void edit() {
    const std::size_t count = edges_.size();
    for (auto& edges : edges_) {
      for (ProgramEdge& edge : edges) {
        if (random_.chance(0.4)) make_joint(edge);
      }
    }
    for (std::size_t at = 0; at < count; ++at) {
      if (edges_[at].empty()) continue;
      if (random_.chance(0.3)) add_arm(at, count);
      if (kinds_.deaths && random_.chance(0.3)) add_death(at);
      if (kinds_.errors && random_.chance(0.1)) add_error(at);
      if (kinds_.rests) program_.states[at].may_rest = random_.chance(0.3);
    }
    program_.edges.clear();
    for (std::size_t at = 0; at < edges_.size(); ++at) {
      program_.states[at].first_edge = static_cast<std::uint32_t>(program_.edges.size());
      program_.states[at].edge_count = static_cast<std::uint32_t>(edges_[at].size());
      program_.edges.insert(program_.edges.end(), edges_[at].begin(), edges_[at].end());
    }
  }

 private:
  std::uint32_t add_joint(CombinedStep joint) {
    for (const ModelUse& use : joint.uses) {
      if (use.kind == Kind::give || use.kind == Kind::take) joint.events.push_back(use);
      joint.text += (joint.text.empty() ? "" : " with ") + describe_use(system_, use);
    }
    if (kinds_.groups && random_.chance(0.5)) {
      joint.fair = static_cast<std::uint32_t>(random_.between(1, 3));
    }
    program_.combined.push_back(std::move(joint));
    return static_cast<std::uint32_t>(program_.combined.size() - 1);
  }

  // The same step with another model's on top, or with none.
  void make_joint(ProgramEdge& edge) {
    CombinedStep joint;
    joint.role = edge.kind == Kind::choice ? CombinedStep::Role::choice : CombinedStep::Role::step;
    if (edge.kind == Kind::choice) joint.text = "choice " + std::to_string(edge.index);
    if (edge.kind != Kind::choice) joint.uses.push_back(edge);
    const auto other = static_cast<std::uint32_t>(random_.below(system_.models.size()));
    const bool is_other = joint.uses.empty() || joint.uses.front().model != other;
    if (is_other && random_.chance(0.6)) joint.uses.push_back(random_use(system_, other, random_));
    edge.index = add_joint(std::move(joint));
    edge.kind = Kind::combined;
    edge.model = 0;
  }

  void add_arm(std::size_t at, std::size_t targets) {
    ProgramEdge edge;
    static_cast<ModelUse&>(edge) = random_use(
        system_, static_cast<std::uint32_t>(random_.below(system_.models.size())), random_);
    edge.target = static_cast<ControlState>(random_.below(targets));
    edge.line = edge.column = 1;
    if (random_.chance(0.5)) make_joint(edge);
    edges_[at].push_back(edge);
  }

  ControlState add_state(std::uint32_t error) {
    Program::State state;
    state.error = error;
    program_.states.push_back(state);
    edges_.emplace_back();
    return static_cast<ControlState>(edges_.size() - 1);
  }

  void add_death(std::size_t at) {
    if (grave_ == 0) grave_ = add_state(0);
    CombinedStep joint;
    joint.role = CombinedStep::Role::death;
    joint.text = "dies";
    program_.combined.push_back(joint);
    ProgramEdge edge;
    edge.kind = Kind::combined;
    edge.index = static_cast<Symbol>(program_.combined.size() - 1);
    edge.target = grave_;
    edges_[at].push_back(edge);
  }

  void add_error(std::size_t at) {
    program_.errors.push_back({"something is wrong", {"random.yaml", 1, 1}});
    const ControlState error = add_state(static_cast<std::uint32_t>(program_.errors.size() - 1));
    edges_[at][random_.below(edges_[at].size())].target = error;
  }

  System& system_;
  Program& program_;
  JointSystemKinds kinds_;
  Random& random_;
  std::vector<std::vector<ProgramEdge>> edges_;  // by control state
  ControlState grave_ = 0;
};

// What happens by itself: a step of one model, or of two together.
void add_nobody(System& system, const JointSystemKinds& kinds, Random& random) {
  system.nobodys_groups = {"", "first", "second"};
  for (std::uint64_t count = random.between(1, 3); count > 0; --count) {
    NobodysAction action;
    const auto one = static_cast<std::uint32_t>(random.below(system.models.size()));
    action.what.uses.push_back(random_use(system, one, random));
    const auto other = static_cast<std::uint32_t>(random.below(system.models.size()));
    if (other != one && random.chance(0.5)) {
      action.what.uses.push_back(random_use(system, other, random));
    }
    for (const ModelUse& use : action.what.uses) {
      if (use.kind == Kind::give || use.kind == Kind::take) action.what.events.push_back(use);
      action.what.text += (action.what.text.empty() ? "" : " with ") + describe_use(system, use);
    }
    action.what.fair = static_cast<std::uint32_t>(random.below(3));
    action.counts_for_deadlock = !kinds.deaths || random.chance(0.7);
    system.nobodys_actions.push_back(std::move(action));
  }
  Program& program = system.programs[random.below(system.programs.size())];
  program.flags.is_fair = random.chance(0.6);
  program.flags.may_rest = kinds.rests && random.chance(0.4);
  program.flags.counts_for_deadlock = !kinds.deaths || random.chance(0.7);
}

}  // namespace

System random_joint_system(Random& random, const RandomSystemSize& size,
                           const JointSystemKinds& kinds) {
  System system = random_system(random, size);
  for (ModelInstance& model : system.models) {
    const auto input = static_cast<Symbol>(random.below(model.automaton.inputs().size()));
    const auto output = static_cast<Symbol>(random.below(model.automaton.outputs().size()));
    model.actions.push_back(input_with_output(model, input, output));
  }
  system.models.push_back(shared_variable(random));
  for (Program& program : system.programs) Editor(system, program, kinds, random).edit();
  if (kinds.nobody) add_nobody(system, kinds, random);
  return system;
}

std::string show(const System& system) {
  std::string text;
  for (const Program& program : system.programs) {
    text += fmt::format("{}{}{}{}\n", program.name, program.flags.is_fair ? "" : " unfair",
                        program.flags.may_rest ? " rests" : "",
                        program.flags.counts_for_deadlock ? "" : " no progress");
    for (ControlState at = 0; at < program.states.size(); ++at) {
      const Program::State& state = program.states[at];
      text += fmt::format("  {}:{}{}\n", at, state.error != 0 ? " error" : "",
                          state.may_rest ? " rests" : "");
      for (const ProgramEdge& edge : program.edges_of(at)) {
        text += fmt::format("    {} -> {} (group {})\n", describe_edge(system, program, edge),
                            edge.target, program.fair_group_of(edge));
        for (const ModelUse& use : program.uses_of(edge)) {
          text += fmt::format("      {}:", describe_use(system, use));
          const ModelInstance& model = system.models[use.model];
          for (StateId from = 0; from < model.automaton.size(); ++from) {
            for (const ModelStep& step : model_steps(model, from, use)) {
              text += fmt::format(" {}->{}{}", from, step.target, step.is_beyond ? "*" : "");
            }
          }
          text += "\n";
        }
      }
    }
  }
  for (const NobodysAction& action : system.nobodys_actions) {
    text += fmt::format("nobody: {} (group {}){}\n", action.what.text, action.what.fair,
                        action.counts_for_deadlock ? "" : " no progress");
  }
  return text;
}

}  // namespace maide::test
