#include "maide/check/system/trace.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/system/atom_view.hpp"

namespace maide {
namespace {

// What the loop of a run does for one program, or for one fair group.
struct LoopShare {
  bool steps = false;        // it steps in it
  bool is_enabled = false;   // it could, somewhere
  bool is_disabled = false;  // it could not, somewhere
  bool is_weakly_fair() const { return steps || is_disabled; }
  bool is_strongly_fair() const { return steps || !is_enabled; }
};

struct LoopShares {
  std::vector<LoopShare> programs;
  std::vector<std::vector<LoopShare>> groups;  // by actor, nobody last; [0] is not used
};

// Whose group it is, nobody being the last, and its number there.
struct FairGroupOf {
  std::size_t actor = 0;
  std::uint32_t group = 0;
};
FairGroupOf fair_group_of(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  return {actor_number(system, doer_of(system, step)), combined == nullptr ? 0 : combined->fair};
}

// Who can go on in a state: programs, and fair groups by actor, nobody last.
struct Enabled {
  std::vector<bool> programs;
  std::vector<std::vector<bool>> groups;
  bool operator==(const Enabled&) const = default;
};

// A program's own step, for fairness: not what befalls it.
bool is_own(const System& system, const Step& step) {
  const CombinedStep* const combined = combined_step_of(system, step);
  return step.actor != nobody &&
         (combined == nullptr || combined->role != CombinedStep::Role::fate);
}

Enabled find_enabled(const System& system, const GlobalState& state) {
  Enabled enabled;
  enabled.programs.resize(system.programs.size());
  for (const Program& program : system.programs) {
    enabled.groups.emplace_back(std::max<std::size_t>(program.fair_groups.size(), 1));
  }
  enabled.groups.emplace_back(std::max<std::size_t>(system.nobodys_groups.size(), 1));
  for (const Step& step : enabled_steps(system, state)) {
    if (is_own(system, step) && is_progress(system, step)) enabled.programs[step.actor] = true;
    const auto [actor, group] = fair_group_of(system, step);
    enabled.groups[actor][group] = true;
  }
  return enabled;
}

LoopShares share_loop(const System& system, const Trace& trace,
                      const std::vector<GlobalState>& states) {
  LoopShares shares;
  MAIDE_CHECK(states.size() == trace.steps.size() + 1);
  MAIDE_CHECK(*trace.loop_start < trace.steps.size());
  shares.programs.resize(system.programs.size());
  for (const Program& program : system.programs) {
    shares.groups.emplace_back(std::max<std::size_t>(program.fair_groups.size(), 1));
  }
  shares.groups.emplace_back(std::max<std::size_t>(system.nobodys_groups.size(), 1));
  const auto group_of = [&](const Step& step) -> LoopShare& {
    const auto [actor, group] = fair_group_of(system, step);
    return shares.groups[actor][group];
  };
  for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
    const Step& taken = trace.steps[at];
    if (is_own(system, taken)) shares.programs[taken.actor].steps = true;
    group_of(taken).steps = true;
    const Enabled enabled = find_enabled(system, states[at]);
    for (std::size_t program = 0; program < enabled.programs.size(); ++program) {
      LoopShare& share = shares.programs[program];
      (enabled.programs[program] ? share.is_enabled : share.is_disabled) = true;
    }
    for (std::size_t actor = 0; actor < enabled.groups.size(); ++actor) {
      for (std::size_t group = 0; group < enabled.groups[actor].size(); ++group) {
        if (enabled.groups[actor][group]) shares.groups[actor][group].is_enabled = true;
      }
    }
  }
  return shares;
}

// Whatever of nobody's can come again and again comes again and again.
bool is_fair_to_nobody(const LoopShares& shares) {
  const std::vector<LoopShare>& groups = shares.groups.back();
  return std::all_of(groups.begin() + 1, groups.end(),
                     [](const LoopShare& share) { return share.is_strongly_fair(); });
}

bool is_fair_loop(const System& system, const LoopShares& shares, Fairness fairness) {
  if (fairness == Fairness::none) return true;
  const bool is_strong = fairness == Fairness::strong;
  for (std::size_t index = 0; index < shares.programs.size(); ++index) {
    const LoopShare& share = shares.programs[index];
    const bool is_asked = system.programs[index].flags.is_fair;
    if (is_asked && !(is_strong ? share.is_strongly_fair() : share.is_weakly_fair())) return false;
    for (std::size_t group = 1; group < shares.groups[index].size(); ++group) {
      if (!is_strong && !system.programs[index].fair_groups[group].on_weak_runs) continue;
      if (!shares.groups[index][group].is_strongly_fair()) return false;
    }
  }
  return is_fair_to_nobody(shares);
}

std::string find_flaw_of_stuck(const System& system, const Trace& trace,
                               const std::vector<GlobalState>& states) {
  if (!trace.loop_start) return "nobody runs on for ever";
  const LoopShares shares = share_loop(system, trace, states);
  if (!is_fair_loop(system, shares, Fairness::strong)) return "the run is not fair";
  for (std::size_t index = 0; index < shares.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState at = states.back().programs[index];
    if (!program.flags.is_fair || program.is_end(at) || program.may_rest(at)) continue;
    if (!shares.programs[index].steps) return "";
  }
  return "every fair program that has not ended steps again";
}

// No progress can come, and the run may end there.
bool may_end(const System& system, const GlobalState& state) {
  const std::vector<Step> steps = enabled_steps(system, state);
  return std::ranges::none_of(steps, [&](const Step& step) { return is_progress(system, step); });
}

// The run as what formulas and automata are evaluated on (see holds_on_lasso). `value` refers to
// the arguments.
struct Positions {
  std::size_t length = 0, loop = 0, cut = never_cut;
  std::function<bool(const Atom&, std::size_t at)> value;
};

Positions positions_of(const System& system, const Trace& trace,
                       const std::vector<GlobalState>& states) {
  const bool loops = trace.loop_start.has_value();
  MAIDE_CHECK(states.size() == trace.steps.size() + 1);
  MAIDE_CHECK(!loops || !states.back().is_cut);  // nothing follows a step that is cut
  Positions run;
  // A run that ends repeats its last state, without the event that led there.
  run.length = states.size() + (loops ? 0 : 1);
  run.loop = loops ? *trace.loop_start + 1 : run.length - 1;
  run.value = [&](const Atom& atom, std::size_t at) {
    const Step* step = at == 0 || at > trace.steps.size() ? nullptr : &trace.steps[at - 1];
    return is_true(atom, system, states[std::min(at, states.size() - 1)], step);
  };
  // A run that is cut, or shown no further, must have a bad prefix: whatever comes, it is violated.
  if (!loops && !may_end(system, states.back())) run.cut = states.size();
  // A step that is cut, or comes to an error, is no position; the initial state is one.
  if (states.back().is_cut || is_error(system, states.back())) {
    run.cut = std::max<std::size_t>(states.size() - 1, 1);
  }
  MAIDE_CHECK(run.loop < run.length && (run.cut == never_cut || run.cut <= run.length));
  return run;
}

std::string find_flaw_of_run(const System& system, const Property& property, const Trace& trace,
                             const std::vector<GlobalState>& states) {
  const bool loops = trace.loop_start.has_value();
  if (loops && !is_fair(system, trace, states, property.fairness)) {
    return "the run is not fair";
  }
  if (property.kind == Property::Kind::ltl) {
    return evaluate_on_run(system, property.formula, trace, states)[0]
               ? "the formula holds on the run"
               : "";
  }
  const Positions run = positions_of(system, trace, states);
  const LtlAutomaton& never = *property.never;
  std::vector<std::uint64_t> valuations(std::min(run.cut, run.length));
  for (std::size_t at = 0; at < valuations.size(); ++at) {
    for (std::size_t atom = 0; atom < never.atoms.size(); ++atom) {
      valuations[at] |= std::uint64_t{run.value(never.atoms[atom], at)} << atom;
    }
  }
  const bool is_bad = run.cut == never_cut ? accepts(never, valuations, run.loop)
                                           : accepts_whatever_comes(never, valuations);
  return is_bad ? "" : "the automaton does not accept the run";
}

}  // namespace

Trace to_whole(const SystemPart& part, Trace trace) {
  for (Step& step : trace.steps) step = part.to_whole(std::move(step));
  return trace;
}

Trace from_whole(const SystemPart& part, Trace trace) {
  for (Step& step : trace.steps) step = part.from_whole(std::move(step));
  return trace;
}

std::optional<Step> step_like(const System& system, const GlobalState& at, const Step& as_told) {
  const std::vector<Step> enabled = enabled_steps(system, at, as_told.actor);
  auto step = std::ranges::find(enabled, as_told);
  if (step == enabled.end()) {
    step = std::ranges::find_if(enabled, [&](const Step& other) {
      return other.action == as_told.action && other.is_beyond == as_told.is_beyond;
    });
  }
  return step == enabled.end() ? std::nullopt : std::optional(*step);
}

namespace {

// Steps of all rounds until one begins where another did.
constexpr std::size_t most_steps_of_rounds = 4096;

// The states along the steps.
std::vector<GlobalState> follow(const System& system, const std::vector<Step>& steps) {
  std::vector<GlobalState> states{initial_state(system)};
  for (const Step& step : steps) {
    if (!is_possible(system, states.back(), step)) {
      throw std::logic_error("step " + std::to_string(states.size()) + " is not possible");
    }
    states.push_back(apply(system, states.back(), step));
  }
  return states;
}

// What a step of a loop looks like: which programs could go on before it, and which atoms are true
// after it.
struct Look {
  Enabled enabled;
  std::vector<bool> atoms;
  bool operator==(const Look&) const = default;
};

Look look_at(const System& system, const std::vector<Atom>& atoms, const GlobalState& before,
             const Step& step, const GlobalState& after) {
  Look look{find_enabled(system, before), {}};
  look.enabled.groups.pop_back();  // nobody's: see closed()
  for (const Atom& atom : atoms) look.atoms.push_back(is_true(atom, system, after, &step));
  return look;
}

}  // namespace

std::vector<GlobalState> replay(const System& system, const Trace& trace) {
  std::vector<GlobalState> states = follow(system, trace.steps);
  if (!trace.loop_start) return states;
  if (*trace.loop_start >= trace.steps.size() || !closed(system, trace, states)) {
    throw std::logic_error("the loop does not repeat");
  }
  return states;
}

namespace {

bool is_fair_to_nobody(const System& system, const Trace& trace) {
  return is_fair_to_nobody(share_loop(system, trace, follow(system, trace.steps)));
}

}  // namespace

std::optional<Trace> closed(const System& system, const Trace& trace,
                            const std::vector<GlobalState>& states, const std::vector<Atom>& atoms,
                            std::uint64_t* looked_at) {
  if (!trace.loop_start || states[*trace.loop_start] == states.back()) return trace;
  const std::size_t first = *trace.loop_start;
  const std::size_t length = trace.steps.size() - first;
  if (states[first].programs != states.back().programs) return std::nullopt;  // no step is the same
  std::vector<Look> looks;
  for (std::size_t at = first; at < trace.steps.size(); ++at) {
    looks.push_back(look_at(system, atoms, states[at], trace.steps[at], states[at + 1]));
  }
  Trace all = trace;
  std::vector<GlobalState> begins{states[first], states.back()};  // of rounds
  std::vector<std::size_t> begins_at{first, trace.steps.size()};
  while (all.steps.size() - first + length <= most_steps_of_rounds) {
    GlobalState at = begins.back();
    for (std::size_t i = 0; i < length; ++i) {
      const auto step = step_like(system, at, trace.steps[first + i]);
      if (looked_at != nullptr) ++*looked_at;
      if (!step && trace.steps[first + i].actor == nobody && atoms.empty()) continue;
      if (!step) return std::nullopt;
      GlobalState after = apply(system, at, *step);
      if (looks[i] != look_at(system, atoms, at, *step, after)) return std::nullopt;
      all.steps.push_back(*step);
      at = std::move(after);
    }
    if (all.steps.size() == begins_at.back()) return std::nullopt;  // nothing is left of the round
    const auto same = std::ranges::find(begins, at);
    if (same != begins.end()) {
      all.loop_start = begins_at[static_cast<std::size_t>(same - begins.begin())];
      if (system.nobodys_actions.empty() || is_fair_to_nobody(system, all) ||
          !is_fair_to_nobody(system, trace)) {
        return all;
      }
      return std::nullopt;
    }
    begins.push_back(std::move(at));
    begins_at.push_back(all.steps.size());
  }
  return std::nullopt;
}

std::vector<std::uint32_t> models_that_change(const Trace& trace,
                                              const std::vector<GlobalState>& states) {
  std::vector<std::uint32_t> models;
  if (!trace.loop_start) return models;
  const auto& before = states[*trace.loop_start].models;
  const auto& after = states.back().models;
  for (std::uint32_t index = 0; index < before.size(); ++index) {
    if (before[index] != after[index]) models.push_back(index);
  }
  return models;
}

std::vector<bool> evaluate_on_run(const System& system, const Formula& formula, const Trace& trace,
                                  const std::vector<GlobalState>& states) {
  const Positions run = positions_of(system, trace, states);
  return evaluate_on_lasso(formula, run.length, run.loop, run.value, run.cut);
}

bool is_fair(const System& system, const Trace& trace, const std::vector<GlobalState>& states,
             Fairness fairness) {
  return is_fair_loop(system, share_loop(system, trace, states), fairness);
}

namespace {

// Without temporal operators.
bool holds_at(const Formula& formula, const std::function<bool(const Atom&)>& value) {
  using Operator = FormulaNode::Operator;
  switch (formula->op) {
    case Operator::truth: return true;
    case Operator::falsity: return false;
    case Operator::atom: return value(formula->atom);
    case Operator::negation: return !holds_at(formula->left, value);
    case Operator::conjunction:
      return holds_at(formula->left, value) && holds_at(formula->right, value);
    case Operator::disjunction:
      return holds_at(formula->left, value) || holds_at(formula->right, value);
    case Operator::implication:
      return !holds_at(formula->left, value) || holds_at(formula->right, value);
    default: return holds_at(formula->left, value) == holds_at(formula->right, value);
  }
}

// States that is_out_of_reach() looks at; beyond them it says yes.
constexpr std::size_t most_states_behind = 20'000;

// No run from the state comes to the expression, nor to bounds or an error. `last`: the step that
// led there, or null.
bool is_out_of_reach(const System& system, const Formula& formula, const GlobalState& state,
                     const Step* last) {
  const auto holds = [&](const GlobalState& at, const Step* by) {
    return holds_at(formula, [&](const Atom& atom) { return is_true(atom, system, at, by); });
  };
  if (holds(state, last) || is_error(system, state)) return false;
  std::vector<GlobalState> met{state};
  const auto key = [](const GlobalState& at) {
    std::uint64_t sum = at.models.size();
    for (const StateId model : at.models) sum = hash_mix(sum, model);
    for (const ControlState program : at.programs) sum = hash_mix(sum, program);
    return sum;
  };
  std::unordered_multimap<std::uint64_t, std::size_t> places{{key(state), 0}};
  for (std::size_t i = 0; i < met.size() && met.size() < most_states_behind; ++i) {
    const GlobalState at = met[i];
    for (const Step& step : enabled_steps(system, at)) {
      if (step.is_cut) return false;
      GlobalState next = apply(system, at, step);
      if (is_error(system, next) || holds(next, &step)) return false;
      const auto [begin, end] = places.equal_range(key(next));
      const bool is_known =
          std::any_of(begin, end, [&](const auto& place) { return met[place.second] == next; });
      if (is_known) continue;
      places.emplace(key(next), met.size());
      met.push_back(std::move(next));
    }
  }
  return true;
}

}  // namespace

std::string find_flaw(const System& system, const Property& property, const Trace& trace) {
  std::vector<GlobalState> states;
  try {
    states = replay(system, trace);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    if (is_error(system, states[i])) return "it goes on behind an error";
  }
  if (!closed(system, trace, states, atoms_of(property))) return "the loop does not repeat";
  if (property.kind == Property::Kind::deadlock) {
    return is_deadlock(system, states.back()) ? "" : "it ends in no deadlock";
  }
  if (property.kind == Property::Kind::error) {
    const bool is_shown = is_error(system, states.back()) && !states.back().is_cut;
    return is_shown ? "" : "it ends in no error";
  }
  if (property.kind == Property::Kind::stuck) return find_flaw_of_stuck(system, trace, states);
  if (property.is_always_possible) {
    const Step* const last = trace.steps.empty() ? nullptr : &trace.steps.back();
    const bool is_shown = is_out_of_reach(system, property.formula, states.back(), last);
    return is_shown ? "" : "it ends where the expression is possible";
  }
  return find_flaw_of_run(system, property, trace, states);
}

namespace {

constexpr std::size_t no_actor = ~std::size_t{0};

// A stretch of a run whose steps are put into another order.
struct Stretch {
  GlobalState begin, end;
  std::span<const Step> steps;
  std::size_t before = no_actor;  // the number of who took the step before it
};

// The search: 0-1 breadth-first, by the number of switches.
class TurnSearch {
 public:
  TurnSearch(const System& system, std::span<const AtomView> views, const Stretch& stretch,
             std::size_t most_nodes)
      : system_(system), stretch_(stretch), most_nodes_(most_nodes), own_(actor_count(system)) {
    for (const Step& step : stretch.steps) {
      const bool visible = is_visible(views, step.actor, step.action);
      own_[actor_number(system, step.actor)].push_back(
          {step, visible ? visible_count_ : not_visible});
      visible_count_ += visible ? 1 : 0;
    }
  }

  // Nothing if there were more nodes than allowed.
  std::optional<std::vector<Step>> run() {
    Key first(own_.size(), 0);
    for (const StateId state : stretch_.begin.models) first.push_back(state);
    first.push_back(static_cast<char32_t>(stretch_.before));
    first.push_back(0);
    visit(std::move(first), no_node, {}, 0);
    while (!now_.empty() || !later_.empty()) {
      if (now_.empty()) std::swap(now_, later_);
      const std::uint32_t at = now_.back();
      now_.pop_back();
      if (std::exchange(nodes_[at].is_done, true)) continue;
      if (is_goal(*nodes_[at].key)) return read_off(at);
      if (nodes_.size() > most_nodes_) return std::nullopt;
      expand(at);
    }
    return std::nullopt;
  }

 private:
  // How far each actor is, where each model is, who stepped last, and how many visible steps were
  // taken (they keep their order).
  using Key = std::u32string;
  static constexpr std::uint32_t no_node = ~std::uint32_t{0};
  static constexpr std::uint32_t not_visible = ~std::uint32_t{0};
  struct OwnStep {
    Step step;
    std::uint32_t visible = not_visible;  // its number among the visible ones
  };
  struct Node {
    const Key* key = nullptr;
    std::uint32_t before = no_node;
    Step step;  // that led here
    std::uint32_t switches = 0;
    bool is_done = false;
  };

  std::size_t models_at() const { return own_.size(); }
  std::size_t last_at() const { return own_.size() + system_.models.size(); }

  bool is_goal(const Key& key) const {
    for (std::size_t actor = 0; actor < own_.size(); ++actor) {
      if (key[actor] != own_[actor].size()) return false;
    }
    return std::equal(stretch_.end.models.begin(), stretch_.end.models.end(),
                      key.begin() + static_cast<std::ptrdiff_t>(models_at()));
  }

  GlobalState state_of(const Key& key) const {
    GlobalState state = stretch_.begin;
    for (std::size_t actor = 0; actor < own_.size(); ++actor) {
      if (key[actor] == 0) continue;
      const Step& step = own_[actor][key[actor] - 1].step;
      if (step.actor != nobody) state.programs[actor] = edge_of(system_, step).target;
      // Only the last step of a run is cut.
      state.is_cut = state.is_cut || step.is_cut;
    }
    for (std::size_t model = 0; model < state.models.size(); ++model) {
      state.models[model] = key[models_at() + model];
    }
    return state;
  }

  void expand(std::uint32_t at) {
    const Key key = *nodes_[at].key;
    for (const Step& step : enabled_steps(system_, state_of(key))) {
      const std::size_t actor = actor_number(system_, step.actor);
      const std::uint32_t done = key[actor];
      if (done == own_[actor].size()) continue;
      const OwnStep& own = own_[actor][done];
      if (step.action != own.step.action || step.is_cut != own.step.is_cut) continue;
      if (own.visible != not_visible && own.visible != key.back()) continue;
      Key next = key;
      ++next[actor];
      const auto uses = uses_of(system_, step);
      for (std::size_t i = 0; i < uses.size(); ++i) {
        next[models_at() + uses[i].model] = step.targets[i];
      }
      const char32_t last = key[last_at()];
      const bool is_switch = last != static_cast<char32_t>(no_actor) && last != actor;
      next[last_at()] = static_cast<char32_t>(actor);
      next.back() += own.visible != not_visible ? 1 : 0;
      visit(std::move(next), at, step, nodes_[at].switches + (is_switch ? 1 : 0));
    }
  }

  void visit(Key key, std::uint32_t before, const Step& step, std::uint32_t switches) {
    const auto [place, is_new] =
        ids_.try_emplace(std::move(key), static_cast<std::uint32_t>(nodes_.size()));
    if (is_new) nodes_.push_back({&place->first, no_node, {}, switches + 1, false});
    Node& node = nodes_[place->second];
    if (switches >= node.switches) return;
    const bool costs = before != no_node && switches > nodes_[before].switches;
    node.before = before;
    node.step = step;
    node.switches = switches;
    (costs ? later_ : now_).push_back(place->second);
  }

  std::vector<Step> read_off(std::uint32_t at) const {
    std::vector<Step> steps;
    for (; nodes_[at].before != no_node; at = nodes_[at].before) steps.push_back(nodes_[at].step);
    std::ranges::reverse(steps);
    return steps;
  }

  const System& system_;
  const Stretch& stretch_;
  std::size_t most_nodes_;
  std::vector<std::vector<OwnStep>> own_;  // each actor's steps
  std::uint32_t visible_count_ = 0;
  std::unordered_map<Key, std::uint32_t> ids_;  // its keys stay where they are
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> now_, later_;  // nodes to expand, with as many switches, and one more
};

// Steps that must come before a step: the one before it of its program, of each of its models, and,
// if it is visible, the visible one. Programs take turns, each going on as long as it can; the one
// that can go farthest comes next. O(steps x programs).
class GreedyTurns {
 public:
  GreedyTurns(const System& system, std::span<const AtomView> views, const Stretch& stretch)
      : steps_(stretch.steps), needs_(stretch.steps.size()), own_(actor_count(system)) {
    std::vector<std::size_t> last_of_model(system.models.size(), none);
    std::size_t last_visible = none;
    for (std::size_t at = 0; at < steps_.size(); ++at) {
      own_[actor_number(system, steps_[at].actor)].push_back(at);
      for (const ModelUse& use : uses_of(system, steps_[at])) {
        MAIDE_CHECK(use.model < last_of_model.size());
        const std::size_t last = std::exchange(last_of_model[use.model], at);
        if (last != none) needs_[at].push_back(last);
      }
      if (is_visible(views, steps_[at].actor, steps_[at].action)) {
        const std::size_t last = std::exchange(last_visible, at);
        if (last != none) needs_[at].push_back(last);
      }
    }
  }

  std::vector<Step> run() {
    std::vector<std::size_t> next(own_.size(), 0);
    is_taken_.assign(steps_.size(), false);
    std::vector<Step> result;
    while (result.size() < steps_.size()) {
      std::size_t best = 0, longest = 0;
      for (std::size_t program = 0; program < own_.size(); ++program) {
        const std::size_t length = count_ready(program, next[program]);
        if (length > longest) best = program, longest = length;
      }
      MAIDE_CHECK(longest > 0);  // the order of the run itself is one that the needs allow
      for (std::size_t i = 0; i < longest; ++i) {
        const std::size_t at = own_[best][next[best]++];
        is_taken_[at] = true;
        result.push_back(steps_[at]);
      }
    }
    return result;
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  std::size_t count_ready(std::size_t program, std::size_t first) {
    std::size_t count = 0;
    const auto& own = own_[program];
    const auto is_met = [&](std::size_t needed) { return is_taken_[needed]; };
    for (; first + count < own.size(); ++count) {
      const std::size_t at = own[first + count];
      if (!std::ranges::all_of(needs_[at], is_met)) break;
      is_taken_[at] = true;  // for those behind it
    }
    for (std::size_t i = 0; i < count; ++i) is_taken_[own[first + i]] = false;
    return count;
  }

  std::span<const Step> steps_;
  std::vector<std::vector<std::size_t>> needs_;  // by step: earlier ones
  std::vector<std::vector<std::size_t>> own_;    // each actor's steps
  std::vector<bool> is_taken_;
};

// Whether the steps are those of the stretch, each actor's in their order.
bool is_reordering(const System& system, const std::vector<Step>& steps, const Stretch& stretch) {
  std::vector<std::vector<std::uint32_t>> own(actor_count(system)), wanted(own.size());
  for (const Step& step : steps) own[actor_number(system, step.actor)].push_back(step.action);
  for (const Step& step : stretch.steps) {
    wanted[actor_number(system, step.actor)].push_back(step.action);
  }
  return own == wanted;
}

std::vector<Step> reorder(const System& system, std::span<const AtomView> views,
                          const Stretch& stretch, std::size_t most_nodes) {
  auto steps = TurnSearch(system, views, stretch, most_nodes).run();
  if (!steps) steps = GreedyTurns(system, views, stretch).run();
  MAIDE_CHECK(is_reordering(system, *steps, stretch));
  return *steps;
}

}  // namespace

std::size_t count_switches(const Trace& trace) {
  std::size_t switches = 0;
  for (std::size_t at = 1; at < trace.steps.size(); ++at) {
    switches += trace.steps[at].actor != trace.steps[at - 1].actor ? 1 : 0;
  }
  return switches;
}

Trace with_fewest_switches(const System& system, const Property& property, const Trace& trace,
                           std::size_t most_nodes) {
  if (trace.steps.empty()) return trace;
  const std::vector<GlobalState> states = replay(system, trace);
  const std::vector<AtomView> views = views_of(atoms_of(property), system);
  const std::size_t split = trace.loop_start.value_or(trace.steps.size());
  const std::span<const Step> steps(trace.steps);
  Trace result;
  result.loop_start = trace.loop_start;
  result.steps = reorder(system, views,
                         {states.front(), states[split], steps.first(split), no_actor}, most_nodes);
  if (trace.loop_start) {
    const std::size_t before =
        result.steps.empty() ? no_actor : actor_number(system, result.steps.back().actor);
    const std::vector<Step> loop = reorder(
        system, views, {states[split], states.back(), steps.subspan(split), before}, most_nodes);
    result.steps.insert(result.steps.end(), loop.begin(), loop.end());
  }
  // A formula may see more than the order of what it sees: how long it lasts (X), or a fair turn.
  const bool is_better = count_switches(result) < count_switches(trace);
  return is_better && find_flaw(system, property, result).empty() ? result : trace;
}

}  // namespace maide
