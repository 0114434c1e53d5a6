#include "maide/check/engines/export/step_rules.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "maide/check/rules/model_words.hpp"

namespace maide {
namespace {

using Bound = ModelRelation::Bound;
using UseKind = ModelUse::Kind;

Bound bound_of(const ModelInstance& model, const ModelStep& step) {
  if (!step.is_beyond) return Bound::within;
  return cuts(model, step) ? Bound::cut : Bound::dropped;
}

}  // namespace

bool uses_second_edition(const System& system) {
  if (!system.nobodys_actions.empty()) return true;
  return std::ranges::any_of(system.programs, [](const Program& program) {
    return program.flags != ActorFlags() ||
           std::ranges::any_of(program.edges,
                               [](const ProgramEdge& edge) {
                                 return edge.kind == UseKind::combined || edge.kind == UseKind::act;
                               }) ||
           std::ranges::any_of(program.states, [](const Program::State& state) {
             return state.error != 0 || state.may_rest || state.waits;
           });
  });
}

bool ModelRelation::changes_nothing() const {
  return std::ranges::all_of(moves, [](const auto& move) { return move.first == move.second; });
}

StepRules::StepRules(const System& system) : system_(system) {
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& use : program.uses_of(edge)) relations_of(use);
    }
  }
  for (const NobodysAction& action : system.nobodys_actions) {
    for (const ModelUse& use : action.what.uses) relations_of(use);
  }
}

const std::vector<std::uint32_t>& StepRules::relations_of(const ModelUse& use) {
  const auto [entry, is_new] = by_use_.try_emplace(use);
  if (!is_new) return entry->second;
  const ModelInstance& model = system_.models[use.model];
  std::array<ModelRelation, 3> found;
  for (StateId at = 0; at < model.automaton.size(); ++at) {
    for (const ModelStep& step : model_steps(model, at, use)) {
      found[static_cast<std::size_t>(bound_of(model, step))].moves.emplace_back(at, step.target);
    }
  }
  for (const Bound bound : {Bound::within, Bound::dropped, Bound::cut}) {
    ModelRelation& relation = found[static_cast<std::size_t>(bound)];
    if (relation.moves.empty()) continue;
    relation.use = use;
    relation.bound = bound;
    entry->second.push_back(static_cast<std::uint32_t>(relations_.size()));
    relations_.push_back(std::move(relation));
  }
  return entry->second;
}

std::vector<StepRule> StepRules::rules_of(std::uint32_t actor, ControlState state) const {
  std::vector<StepRule> rules;
  if (actor == nobody) {
    for (std::uint32_t action = 0; action < system_.nobodys_actions.size(); ++action) {
      add_rules({nobody, 0, action, {}, false, false}, rules);
    }
    return rules;
  }
  const Program::State& control = system_.programs[actor].states[state];
  for (std::uint32_t offset = 0; offset < control.edge_count; ++offset) {
    add_rules({actor, state, control.first_edge + offset, {}, false, false}, rules);
  }
  return rules;
}

// Appends the rule with each relation of its further uses.
void StepRules::add_rules(const StepRule& begun, std::vector<StepRule>& rules) const {
  const std::span<const ModelUse> uses = uses_of(system_, begun_step(begun));
  if (begun.relations.size() == uses.size()) {
    rules.push_back(begun);
    return;
  }
  for (const std::uint32_t number : by_use_.at(uses[begun.relations.size()])) {
    StepRule rule = begun;
    rule.relations.push_back(number);
    rule.is_beyond = rule.is_beyond || relations_[number].bound != Bound::within;
    rule.is_cut = rule.is_cut || relations_[number].bound == Bound::cut;
    add_rules(rule, rules);
  }
}

bool StepRules::may_cut() const {
  return std::ranges::any_of(
      relations_, [](const ModelRelation& relation) { return relation.bound == Bound::cut; });
}

Step StepRules::begun_step(const StepRule& rule) {
  return {rule.actor, rule.action, {}, rule.is_beyond, rule.is_cut};
}

RuleAction StepRules::action_of(const StepRule& rule) const {
  return {maide::action_of(system_, begun_step(rule)), rule.relations};
}

const std::string& StepRules::name_of(const RuleAction& action, ExportNames& names,
                                      bool of_program) const {
  const std::string& name = names.of(action.action, system_, of_program);
  if (!action.action.is_beyond || action.action.kind != UseKind::combined) return name;
  std::string models;  // of which an input is beyond
  for (const std::uint32_t number : action.relations) {
    const ModelRelation& relation = relations_[number];
    if (relation.bound == Bound::within) continue;
    models += (models.empty() ? "" : "_") + system_.models[relation.model()].name;
  }
  return names.of({name, models});
}

std::string StepRules::describe(const ModelRelation& relation) const {
  std::string text = describe_use(system_, relation.use);
  if (relation.bound == Bound::within) return text;
  return text + (relation.bound == Bound::cut ? " beyond" : " dropped");
}

std::optional<Step> StepRules::step_of(const StepRule& rule,
                                       const std::vector<std::uint32_t>& ranks,
                                       const GlobalState& state) const {
  if (rule.actor != nobody && state.programs[rule.actor] != rule.source) return std::nullopt;
  Step step = begun_step(rule);
  for (std::size_t i = 0; i < rule.relations.size(); ++i) {
    const ModelRelation& relation = relations_[rule.relations[i]];
    const StateId at = state.models[relation.model()];
    const auto [first, last] = std::equal_range(
        relation.moves.begin(), relation.moves.end(), std::pair<StateId, StateId>{at, 0},
        [](const auto& one, const auto& other) { return one.first < other.first; });
    if (ranks[i] >= last - first) return std::nullopt;
    step.targets.push_back((first + ranks[i])->second);
  }
  return step;
}

}  // namespace maide
