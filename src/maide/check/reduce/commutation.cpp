#include "maide/check/reduce/commutation.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>
#include <stdexcept>
#include <tuple>

#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"

namespace maide {

std::vector<std::vector<ModelUse>> find_actions(const System& system) {
  std::vector<std::vector<ModelUse>> actions(system.models.size());
  const auto add = [&](std::span<const ModelUse> uses) {
    for (const ModelUse& use : uses) {
      auto& known = actions[use.model];
      if (action_number(known, use) == known.size()) known.push_back(use);
    }
  };
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) add(program.uses_of(edge));
  }
  for (const NobodysAction& action : system.nobodys_actions) add(action.what.uses);
  return actions;
}

std::uint32_t action_number(const std::vector<ModelUse>& actions, const ModelUse& use) {
  const auto place = std::ranges::find_if(actions, [&use](const ModelUse& other) {
    return other.kind == use.kind &&
           (use.kind == ModelUse::Kind::quiet || other.index == use.index);
  });
  return static_cast<std::uint32_t>(place - actions.begin());
}

Commutation::Commutation(const ModelInstance& model, const std::vector<ModelUse>& actions,
                         Watch watch, std::uint64_t strongly_fair)
    : states_(model.automaton.size()),
      watch_(watch),
      strongly_fair_(strongly_fair),
      sources_(actions.size()),
      disturbed_(actions.size() * actions.size()),
      undisturbed_(actions.size()),
      coming_(actions.size()) {
  if (actions.size() > 64) throw std::invalid_argument("too many actions for a set of bits");
  for (const ModelUse& action : actions) {
    is_call_.push_back(action.kind == ModelUse::Kind::act && model.actions[action.index].is_call);
    auto& outcomes = outcomes_.emplace_back(states_);
    for (StateId at = 0; at < states_; ++at) {
      for (const ModelStep& step : model_steps(model, at, action)) {
        outcomes[at].push_back({step.target, cuts(model, step)});
      }
      std::ranges::sort(outcomes[at]);
    }
    find_sources(outcomes_.size() - 1);
  }
}

// What is said of one y and one b in the header.
bool Commutation::commute(std::size_t a, std::size_t b, StateId at) const {
  MAIDE_CHECK(a < outcomes_.size() && b < outcomes_.size() && at < states_);
  if (!is_possible(b, at)) return true;
  const bool was_possible = is_possible(a, at);
  for (const Outcome& after_b : outcomes_[b][at]) {
    if (is_possible(a, after_b.target) != was_possible) return false;
  }
  if (!was_possible) return true;
  using Both = std::tuple<Outcome, bool>;  // the last state and whether b is cut, whether a is
  std::vector<Both> a_first;
  for (const Outcome& after_a : outcomes_[a][at]) {
    for (const Outcome& end : outcomes_[b][after_a.target]) {
      a_first.emplace_back(end, after_a.is_cut);
    }
  }
  for (const Outcome& after_b : outcomes_[b][at]) {
    for (const Outcome& end : outcomes_[a][after_b.target]) {
      const Both both{{end.target, after_b.is_cut}, end.is_cut};
      if (std::ranges::find(a_first, both) == a_first.end()) return false;
    }
    for (const Outcome& after_a : outcomes_[a][at]) {
      const auto& ends = outcomes_[b][after_a.target];
      const bool meet = std::ranges::any_of(ends, [&](const Outcome& end) {
        const auto& others = outcomes_[a][after_b.target];
        return end.is_cut == after_b.is_cut &&
               std::ranges::find(others, Outcome{end.target, after_a.is_cut}) != others.end();
      });
      if (!meet) return false;
    }
  }
  return true;
}

bool Commutation::makes_possible(std::size_t a, std::size_t b, StateId at) const {
  if (is_possible(b, at)) return false;
  const auto& outcomes = outcomes_[a][at];
  return std::ranges::any_of(
      outcomes, [&](const Outcome& outcome) { return is_possible(b, outcome.target); });
}

bool Commutation::is_disturbed(std::size_t a, std::size_t b, StateId at) const {
  if (!commute(a, b, at)) return true;
  if (watch_ == Watch::strong) return makes_possible(a, b, at);
  if ((strongly_fair_ >> b & 1) != 0 && makes_possible(a, b, at)) return true;
  return watch_ == Watch::weak && (is_call_[a] || is_call_[b]) && is_possible(b, at);
}

void Commutation::find_sources(std::size_t action) {
  Sources& sources = sources_[action];
  sources.first.assign(states_ + 1, 0);
  for (const auto& outcomes : outcomes_[action]) {
    for (const Outcome& outcome : outcomes) ++sources.first[outcome.target + 1];
  }
  std::partial_sum(sources.first.begin(), sources.first.end(), sources.first.begin());
  sources.states.resize(sources.first.back());
  std::vector<std::uint32_t> place(sources.first.begin(), sources.first.end() - 1);
  for (StateId at = 0; at < states_; ++at) {
    for (const Outcome& outcome : outcomes_[action][at]) {
      sources.states[place[outcome.target]++] = at;
    }
  }
}

const Commutation::States& Commutation::disturbed(std::size_t a, std::size_t b) {
  std::optional<States>& known = disturbed_[a * outcomes_.size() + b];
  if (!known) {
    known.emplace(states_, 0);
    for (StateId at = 0; at < states_; ++at) (*known)[at] = is_disturbed(a, b, at) ? 1 : 0;
  }
  return *known;
}

void Commutation::spread_backwards(States& marked, std::uint64_t others) const {
  MAIDE_CHECK(marked.size() == states_);
  std::vector<StateId> open;
  for (StateId at = 0; at < states_; ++at) {
    if (marked[at] != 0) open.push_back(at);
  }
  while (!open.empty()) {
    const StateId at = open.back();
    open.pop_back();
    for (std::uint64_t left = others; left != 0; left &= left - 1) {
      const Sources& sources = sources_[static_cast<std::size_t>(std::countr_zero(left))];
      for (std::uint32_t i = sources.first[at]; i < sources.first[at + 1]; ++i) {
        const StateId source = sources.states[i];
        if (marked[source] != 0) continue;
        marked[source] = 1;
        open.push_back(source);
      }
    }
  }
}

void Commutation::add_enabled(std::size_t action, std::uint64_t others, States& disturbed) const {
  for (std::uint64_t left = others; left != 0; left &= left - 1) {
    const auto b = static_cast<std::size_t>(std::countr_zero(left));
    States enabling(states_, 0), possible(states_, 0);
    for (StateId at = 0; at < states_; ++at) {
      enabling[at] = makes_possible(action, b, at) ? 1 : 0;
      possible[at] = is_possible(b, at) ? 1 : 0;
    }
    if (std::ranges::count(enabling, 1) == 0) continue;
    spread_backwards(enabling, others);
    spread_backwards(possible, others);
    for (StateId at = 0; at < states_; ++at) {
      if (enabling[at] != 0 && possible[at] != 0) disturbed[at] = 1;
    }
  }
}

Commutation::States Commutation::find_undisturbed(std::size_t action, std::uint64_t others) {
  States found(states_, 0);
  for (std::uint64_t left = others; left != 0; left &= left - 1) {
    const States& by_one = disturbed(action, static_cast<std::size_t>(std::countr_zero(left)));
    for (StateId at = 0; at < states_; ++at) found[at] |= by_one[at];
  }
  spread_backwards(found, others);
  if (watch_ == Watch::weak) add_enabled(action, others, found);
  for (std::uint8_t& value : found) value = value == 0 ? 1 : 0;
  return found;
}

Commutation::States Commutation::find_coming(std::size_t action, std::uint64_t others) {
  States coming(states_, 0);
  for (StateId at = 0; at < states_; ++at) coming[at] = is_possible(action, at) ? 1 : 0;
  spread_backwards(coming, others);
  return coming;
}

const Commutation::States& Commutation::answer(Answers& known, Question question,
                                               std::size_t action, std::uint64_t others) {
  MAIDE_CHECK((others & ~low_bits(static_cast<unsigned>(outcomes_.size()))) == 0);
  const auto place = known[action].find(others);
  if (place != known[action].end()) return place->second;
  return known[action].emplace(others, (this->*question)(action, others)).first->second;
}

const std::vector<std::uint8_t>& Commutation::undisturbed(std::size_t action,
                                                          std::uint64_t others) {
  return answer(undisturbed_, &Commutation::find_undisturbed, action, others);
}

const std::vector<std::uint8_t>& Commutation::may_come(std::size_t action, std::uint64_t others) {
  return answer(coming_, &Commutation::find_coming, action, others);
}

}  // namespace maide
