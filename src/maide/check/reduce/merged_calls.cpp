#include "maide/check/reduce/merged_calls.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

using Kind = ModelUse::Kind;

// ---- One kind of call ---------------------------------------------------------------------------

// What a program's call does with its model while other programs may do `others` with it.
class Call {
 public:
  Call(const ModelInstance& model, const ModelUse& give, const std::vector<ModelUse>& answers,
       const std::vector<ModelUse>& own, const std::vector<ModelUse>& others)
      : model_(model), give_(give), answers_(answers), others_(others) {
    std::vector<bool> is_reached(model.automaton.size());
    const auto reach = [&](StateId at) {
      if (is_reached[at]) return;
      is_reached[at] = true;
      reached_.push_back(at);
    };
    reach(model.automaton.initial());
    for (std::size_t i = 0; i < reached_.size(); ++i) {
      for (const auto* actions : {&own, &others}) {
        for (const ModelUse& use : *actions) {
          for (const ModelStep& step : model_steps(model_, reached_[i], use)) reach(step.target);
        }
      }
    }
  }

  // The states in which the model may be.
  const std::vector<StateId>& reached() const { return reached_; }

  // An answer is due there, and nobody else can do anything with the model before it is taken.
  bool is_due(StateId behind) const {
    const bool is_answered = std::ranges::any_of(answers_, [&](const auto& answer) {
      return answer.kind == Kind::take && can(answer, behind);
    });
    return is_answered &&
           std::ranges::none_of(others_, [&](const ModelUse& other) { return can(other, behind); });
  }

  // The input may be given as late as just before its answer is taken.
  bool may_be_put_off(bool is_fair) const {
    return std::ranges::all_of(reached_, [&](StateId at) {
      bool waits = false, is_answered = false;
      for (const ModelStep& given : model_steps(model_, at, give_)) {
        if (given.is_beyond) continue;
        const bool is_due_here = is_due(given.target);
        if (!is_due_here && !is_waiting(given.target)) return false;
        (is_due_here ? is_answered : waits) = true;
      }
      return (!waits || closes_diamonds(at)) && (!is_fair || !is_answered || stays_answered(at));
    });
  }

 private:
  bool can(const ModelUse& use, StateId at) const { return !model_steps(model_, at, use).empty(); }

  bool is_waiting(StateId behind) const {
    return std::ranges::none_of(answers_,
                                [&](const ModelUse& answer) { return can(answer, behind); });
  }

  // Giving there and then what others do is the same as the other way round: the same is possible,
  // and leads to the same.
  bool closes_diamonds(StateId at) const {
    const auto given = model_steps(model_, at, give_);
    if (given.size() != 1) return false;
    return std::ranges::all_of(others_, [&](const ModelUse& other) {
      std::set<ModelStep> given_last;
      for (const ModelStep& first : model_steps(model_, at, other)) {
        const auto then = model_steps(model_, first.target, give_);
        if (then.size() != 1 || then.front().is_beyond) return false;
        given_last.insert({then.front().target, first.is_beyond});
      }
      const auto after = model_steps(model_, given.front().target, other);
      return std::set<ModelStep>(after.begin(), after.end()) == given_last;
    });
  }

  // Others do not take the answer away, and the call takes nothing from them.
  bool stays_answered(StateId at) const {
    for (const ModelUse& other : others_) {
      const auto first = model_steps(model_, at, other);
      for (const ModelStep& step : first) {
        for (const ModelStep& given : model_steps(model_, step.target, give_)) {
          if (!given.is_beyond && is_waiting(given.target)) return false;
        }
      }
      if (first.empty()) continue;
      for (const ModelStep& given : model_steps(model_, at, give_)) {
        if (given.is_beyond || !is_due(given.target)) continue;
        for (const ModelUse& answer : answers_) {
          for (const ModelStep& end : model_steps(model_, given.target, answer)) {
            if (!can(other, end.target)) return false;
          }
        }
      }
    }
    return true;
  }

  const ModelInstance& model_;
  const ModelUse give_;
  const std::vector<ModelUse>& answers_;
  const std::vector<ModelUse>& others_;
  std::vector<StateId> reached_;
};

void add_new(std::vector<ModelUse>& to, const ModelUse& use) {
  if (std::ranges::find(to, use) == to.end()) to.push_back(use);
}

// An input behind which the program does nothing but wait for answers, none of which is an error.
bool may_merge(const Program& program, ControlState at, const ProgramEdge& give) {
  if (give.kind != Kind::give || give.target == at) return false;
  const auto answers = program.edges_of(give.target);
  return !answers.empty() && std::ranges::all_of(answers, [&](const auto& answer) {
    return (answer.kind == Kind::take || answer.kind == Kind::quiet) &&
           answer.model == give.model && !program.is_error(answer.target);
  });
}

}  // namespace

// ---- The reduced system -------------------------------------------------------------------------

MergedCalls::MergedCalls(const System& system, const CallRules& rules)
    : plain_(system), merged_(system), uses_(system.programs.size()) {
  const auto count = static_cast<std::uint32_t>(system.programs.size());
  for (const Program& program : system.programs) {
    group_of_.emplace_back(program.edges.size(), none);
    auto& origins = origins_.emplace_back();
    for (std::uint32_t edge = 0; edge < program.edges.size(); ++edge)
      origins.push_back({edge, none});
  }
  for (const NobodysAction& action : system.nobodys_actions) {
    for (const ModelUse& use : action.what.uses) nobodys_models_.insert(use.model);
  }
  for (std::uint32_t program = 0; program < count; ++program) find_uses(program);
  // Each program is reduced in the system that the ones before it have left.
  for (std::uint32_t program = 0; program < count; ++program) {
    const std::size_t groups = groups_.size();
    merge_calls_of(program, rules);
    if (groups_.size() > groups) find_uses(program);
  }
  for (std::uint32_t program = 0; program < count; ++program) rebuild(program);
}

bool MergedCalls::has_calls(const System& system) {
  return std::ranges::any_of(system.programs, [](const Program& program) {
    for (ControlState at = 0; at < program.states.size(); ++at) {
      for (const ProgramEdge& edge : program.edges_of(at)) {
        if (may_merge(program, at, edge)) return true;
      }
    }
    return false;
  });
}

void MergedCalls::merge_calls_of(std::uint32_t index, const CallRules& rules) {
  const Program& program = plain_.programs[index];
  const auto is_seen = [&](std::uint32_t edge) {
    return !rules.visible.empty() && rules.visible[index][edge];
  };
  // By input, answers, and whether it may be put off: what a program does in each round of a
  // `repeat` is one kind of call, and few kinds are few actions of the model.
  std::map<std::tuple<ModelUse, std::vector<ModelUse>, bool>, std::uint32_t> known;
  for (ControlState at = 0; at < program.states.size(); ++at) {
    const Program::State& state = program.states[at];
    for (std::uint32_t edge = state.first_edge; edge < state.first_edge + state.edge_count;
         ++edge) {
      if (!may_merge(program, at, program.edges[edge])) continue;
      const ControlState behind = program.edges[edge].target;
      const Program::State& awaits = program.states[behind];
      bool is_answer_seen = false;
      for (std::uint32_t i = 0; i < awaits.edge_count; ++i) {
        is_answer_seen = is_answer_seen || is_seen(awaits.first_edge + i);
      }
      if (is_seen(edge) && is_answer_seen) continue;
      const bool may_put_off =
          !is_seen(edge) && state.edge_count == 1 && state.may_rest == awaits.may_rest;
      const ModelUse& give = program.edges[edge];
      std::vector<ModelUse> answers;
      for (const ProgramEdge& answer : program.edges_of(behind)) add_new(answers, answer);
      const auto [place, is_new] = known.try_emplace({give, answers, may_put_off}, none);
      if (is_new) {
        place->second = find_group(index, give, std::move(answers), may_put_off, rules.is_fair);
      }
      group_of_[index][edge] = place->second;
    }
  }
}

std::uint32_t MergedCalls::find_group(std::uint32_t program, const ModelUse& give,
                                      std::vector<ModelUse> answers, bool may_put_off,
                                      bool is_fair) {
  Group group;
  group.give = give;
  group.answers = std::move(answers);
  const auto own = uses_[program].find(give.model);
  if (own == uses_[program].end()) return none;  // control never comes there
  if (nobodys_models_.contains(give.model)) return none;
  std::vector<ModelUse> others;
  for (std::uint32_t other = 0; other < uses_.size(); ++other) {
    const auto use = uses_[other].find(give.model);
    if (other == program || use == uses_[other].end()) continue;
    if (is_fair && !use->second.is_alone) return none;
    for (const ModelUse& action : use->second.actions) add_new(others, action);
  }
  const ModelInstance& model = merged_.models[give.model];
  const Call call(model, give, group.answers, own->second.actions, others);
  group.is_due.assign(model.automaton.size(), false);
  bool is_any = false;
  for (const StateId at : call.reached()) {
    for (const ModelStep& given : model_steps(model, at, give)) {
      if (!given.is_beyond && call.is_due(given.target)) group.is_due[given.target] = is_any = true;
    }
  }
  if (!is_any) return none;
  group.is_put_off = may_put_off && call.may_be_put_off(is_fair);
  for (const ModelUse& answer : group.answers) {
    group.calls.push_back(answer.kind == Kind::take ? add_call(give, answer, group.is_due) : none);
  }
  group.rest = add_rest(group);
  groups_.push_back(std::move(group));
  return static_cast<std::uint32_t>(groups_.size() - 1);
}

std::uint32_t MergedCalls::add_call(const ModelUse& give, const ModelUse& answer,
                                    const std::vector<bool>& is_due) {
  ModelInstance& model = merged_.models[give.model];
  ModelAction action{model.automaton.inputs().name(give.index) + " -> " +
                         model.automaton.outputs().name(answer.index),
                     {},
                     true};
  bool is_any = false;
  for (StateId at = 0; at < model.automaton.size(); ++at) {
    auto& steps = action.steps.emplace_back();
    for (const ModelStep& given : model_steps(model, at, give)) {
      if (given.is_beyond || !is_due[given.target]) continue;
      for (const ModelStep& taken : model_steps(model, given.target, answer)) {
        if (std::ranges::find(steps, taken) == steps.end()) steps.push_back(taken);
      }
    }
    is_any = is_any || !steps.empty();
  }
  if (!is_any) return none;
  model.actions.push_back(std::move(action));
  return static_cast<std::uint32_t>(model.actions.size() - 1);
}

std::uint32_t MergedCalls::add_rest(const Group& group) {
  ModelInstance& model = merged_.models[group.give.model];
  ModelAction action{model.automaton.inputs().name(group.give.index), {}, false};
  bool is_any = false;
  for (StateId at = 0; at < model.automaton.size(); ++at) {
    auto& steps = action.steps.emplace_back();
    for (const ModelStep& given : model_steps(model, at, group.give)) {
      const bool is_left = given.is_beyond || (!group.is_due[given.target] && !group.is_put_off);
      if (is_left) steps.push_back(given);
    }
    is_any = is_any || !steps.empty();
  }
  if (!is_any) return none;
  model.actions.push_back(std::move(action));
  return static_cast<std::uint32_t>(model.actions.size() - 1);
}

// What the edge does in the reduced system: one of these uses, or all if it is not merged.
std::vector<ModelUse> MergedCalls::uses_of(std::uint32_t index, std::uint32_t edge) const {
  const Program& program = plain_.programs[index];
  const std::uint32_t number = group_of_[index][edge];
  if (number == none) {
    const auto uses = program.uses_of(program.edges[edge]);
    return {uses.begin(), uses.end()};
  }
  const Group& group = groups_[number];
  std::vector<ModelUse> uses;
  for (const std::uint32_t call : group.calls) {
    if (call != none) uses.push_back({Kind::act, group.give.model, call});
  }
  if (group.rest != none) uses.push_back({Kind::act, group.give.model, group.rest});
  return uses;
}

void MergedCalls::find_uses(std::uint32_t index) {
  const Program& program = plain_.programs[index];
  auto& uses = uses_[index];
  uses.clear();
  std::vector<bool> is_reached(program.states.size());
  std::vector<ControlState> open;
  const auto reach = [&](ControlState at) {
    if (is_reached[at]) return;
    is_reached[at] = true;
    open.push_back(at);
  };
  reach(0);
  while (!open.empty()) {
    const Program::State& state = program.states[open.back()];
    open.pop_back();
    std::map<std::uint32_t, std::uint32_t> using_edges;  // by model
    std::uint32_t edges = 0;                             // but for deaths
    for (std::uint32_t edge = state.first_edge; edge < state.first_edge + state.edge_count;
         ++edge) {
      const ControlState target = program.edges[edge].target;
      const std::uint32_t group = group_of_[index][edge];
      if (group == none || groups_[group].rest != none) reach(target);
      if (group != none) {
        for (const ProgramEdge& answer : program.edges_of(target)) reach(answer.target);
      }
      edges += program.is_death(program.edges[edge]) ? 0 : 1;
      const std::vector<ModelUse> done = uses_of(index, edge);
      const bool is_combined = group == none && done.size() > 1;
      std::set<std::uint32_t> models;
      for (const ModelUse& one : done) {
        Use& use = uses[one.model];
        add_new(use.actions, one);
        use.is_alone = use.is_alone && !is_combined;
        models.insert(one.model);
      }
      for (const std::uint32_t model : models) ++using_edges[model];
    }
    for (const auto& [model, count] : using_edges) {
      if (count < edges) uses[model].is_alone = false;
    }
  }
}

void MergedCalls::rebuild(std::uint32_t index) {
  const Program& program = plain_.programs[index];
  const auto& groups = group_of_[index];
  if (std::ranges::all_of(groups, [](std::uint32_t group) { return group == none; })) {
    return;
  }
  Program& merged = merged_.programs[index];
  merged.edges.clear();
  origins_[index].clear();
  for (ControlState at = 0; at < program.states.size(); ++at) {
    const Program::State& state = program.states[at];
    merged.states[at].first_edge = static_cast<std::uint32_t>(merged.edges.size());
    for (std::uint32_t edge = state.first_edge; edge < state.first_edge + state.edge_count;
         ++edge) {
      if (groups[edge] != none) {
        add_merged(index, edge, merged);
        continue;
      }
      merged.edges.push_back(program.edges[edge]);
      origins_[index].push_back({edge, none});
    }
    merged.states[at].edge_count =
        static_cast<std::uint32_t>(merged.edges.size()) - merged.states[at].first_edge;
  }
}

void MergedCalls::add_merged(std::uint32_t index, std::uint32_t number, Program& merged) {
  const Program& program = plain_.programs[index];
  const ProgramEdge& edge = program.edges[number];
  const Group& group = groups_[group_of_[index][number]];
  const ModelInstance& model = merged_.models[edge.model];
  const auto add = [&](std::uint32_t action, std::vector<ModelUse> events, ControlState target,
                       std::uint32_t taken) {
    CombinedStep combined;
    combined.uses = {{Kind::act, edge.model, action}};
    combined.events = std::move(events);
    combined.text = model.name + "." + model.actions[action].name;
    merged.combined.push_back(std::move(combined));
    const auto symbol = static_cast<Symbol>(merged.combined.size() - 1);
    merged.edges.push_back(
        {{Kind::combined, 0, symbol}, target, edge.line, edge.column, edge.origin});
    origins_[index].push_back({number, taken});
  };
  const Program::State& awaits = program.states[edge.target];
  for (std::uint32_t i = 0; i < awaits.edge_count; ++i) {
    const std::uint32_t taken = awaits.first_edge + i;
    const ModelUse& answer = program.edges[taken];
    const auto place = std::ranges::find(group.answers, answer);
    const std::uint32_t call = group.calls[static_cast<std::size_t>(place - group.answers.begin())];
    if (call != none) add(call, {group.give, answer}, program.edges[taken].target, taken);
  }
  if (group.rest != none) add(group.rest, {group.give}, edge.target, none);
}

// ---- Traces -------------------------------------------------------------------------------------

Trace MergedCalls::expand(const Trace& trace) const {
  std::vector<bool> steps(plain_.programs.size());  // again and again
  if (trace.loop_start) {
    for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
      if (trace.steps[at].actor != nobody) steps[trace.steps[at].actor] = true;
    }
  }
  Trace expanded;
  GlobalState state = initial_state(plain_), reduced = state;
  std::vector<ModelUse> given;
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    if (trace.loop_start == at) {
      give_what_was_put_off(steps, state, expanded, given);
      expanded.loop_start = expanded.steps.size();
    }
    Step step = trace.steps[at];
    reduced = apply(merged_, reduced, step);
    const auto uses = maide::uses_of(merged_, step);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      for (const ModelUse& give : given) {
        if (give.model != uses[i].model) continue;
        step.targets[i] =
            model_steps(plain_.models[give.model], step.targets[i], give).front().target;
      }
    }
    expand(step, state, expanded);
  }
  if (!trace.loop_start && is_over(merged_, reduced) && !is_error(plain_, state)) {
    give_what_was_put_off(steps, state, expanded, given);
  }
  return expanded;
}

void MergedCalls::expand(const Step& step, GlobalState& state, Trace& trace) const {
  const auto add = [&](Step one) {
    state = apply(plain_, state, one);
    trace.steps.push_back(std::move(one));
  };
  if (step.actor == nobody) return add(step);
  const Origin origin = origins_[step.actor][step.action];
  const Program& program = plain_.programs[step.actor];
  if (origin.taken == none) {
    Step one = step;
    one.action = origin.edge;
    return add(std::move(one));
  }
  const Group& group = groups_[group_of_[step.actor][origin.edge]];
  const ModelInstance& model = plain_.models[group.give.model];
  for (const ModelStep& given : model_steps(model, state.models[group.give.model], group.give)) {
    if (given.is_beyond || !group.is_due[given.target]) continue;
    const auto ends = model_steps(model, given.target, program.edges[origin.taken]);
    if (std::ranges::find(ends, ModelStep{step.targets.front(), false}) == ends.end()) {
      continue;
    }
    add({step.actor, origin.edge, {given.target}, false, false});
    return add({step.actor, origin.taken, step.targets, false, false});
  }
  throw std::logic_error("a call is not two steps");
}

// Programs that never step again may wait behind an input that was put off. In the system itself
// they give it, or the run would not be fair to them, or would not end there.
void MergedCalls::give_what_was_put_off(const std::vector<bool>& steps, GlobalState& state,
                                        Trace& trace, std::vector<ModelUse>& given) const {
  if (state.is_cut) return;
  for (std::uint32_t index = 0; index < plain_.programs.size(); ++index) {
    const Program::State& at = plain_.programs[index].states[state.programs[index]];
    if (steps[index] || at.edge_count != 1) continue;
    const std::uint32_t number = group_of_[index][at.first_edge];
    if (number == none || !groups_[number].is_put_off) continue;
    const ModelUse& give = groups_[number].give;
    const auto outcomes = model_steps(plain_.models[give.model], state.models[give.model], give);
    if (outcomes.size() != 1 || outcomes.front().is_beyond ||
        groups_[number].is_due[outcomes.front().target]) {
      continue;
    }
    Step step{index, at.first_edge, {outcomes.front().target}, false, false};
    state = apply(plain_, state, step);
    trace.steps.push_back(std::move(step));
    given.push_back(give);
  }
}

}  // namespace maide
