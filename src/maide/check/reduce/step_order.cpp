#include "maide/check/reduce/step_order.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/check/reduce/commutation.hpp"

namespace maide {
namespace {

// Most pairs of actions, or of actors and actions, of one model, times its states. A larger model
// would take longer than the order of its steps saves.
constexpr std::uint64_t most_pairs = std::uint64_t{1} << 20;

// An actor's action: what it does with models, and whether it leads to an error.
struct Taken {
  std::span<const ModelUse> uses;
  bool is_error = false;
  bool is_kept() const { return uses.size() > 1 || is_error; }
};
Taken taken_by(const PackedSystem& packed, std::size_t actor, std::size_t action) {
  Taken taken{packed.uses_of(actor, action)};
  if (actor < packed.program_count()) {
    const Program& program = packed.system().programs[actor];
    taken.is_error = program.is_error(program.edges[action].target);
  }
  return taken;
}

}  // namespace

StepOrder::StepOrder(const PackedSystem& packed) {
  const System& system = packed.system();
  for (std::size_t p = 0; p < packed.actor_count(); ++p) {
    steps_.emplace_back(packed.edges_of(p).second);
  }
  if (steps_.size() > most_actors_in_a_word) return;
  for (std::uint32_t p = 0; p < steps_.size(); ++p) {
    const auto choice = static_cast<std::uint32_t>(lasts_.size());
    lasts_.push_back({0, no_model, p});
    for (auto [i, end] = packed.edges_of(p); i < end; ++i) {
      const Taken taken = taken_by(packed, p, i);
      steps_[p][i].is_kept = taken.is_kept();
      if (taken.uses.empty() && !taken.is_kept()) steps_[p][i].first = choice;
    }
  }
  const std::vector<std::vector<ModelUse>> actions = find_actions(system);
  for (std::uint32_t m = 0; m < system.models.size(); ++m) add_model(packed, m, actions[m]);
}

void StepOrder::add_model(const PackedSystem& packed, std::uint32_t model,
                          const std::vector<ModelUse>& actions) {
  if (actions.empty()) return;
  const System& system = packed.system();
  const std::size_t states = system.models[model].automaton.size();
  const std::size_t widest = std::max(actions.size(), steps_.size());
  const bool is_known =
      actions.size() <= no_action && states * actions.size() * widest <= most_pairs;
  // By action and state: what commutes with it.
  std::vector<std::vector<std::uint64_t>> commuting(actions.size());
  if (is_known) {
    const Commutation commutation(system.models[model], actions, Commutation::Watch::nothing);
    for (std::size_t a = 0; a < actions.size(); ++a) {
      for (StateId at = 0; at < states; ++at) {
        std::uint64_t& set = commuting[a].emplace_back(0);
        for (std::size_t b = 0; b < actions.size(); ++b) {
          if (commutation.commute(b, a, at)) set |= std::uint64_t{1} << b;
        }
      }
    }
  }
  for (std::uint32_t p = 0; p < steps_.size(); ++p) {
    std::map<std::uint32_t, std::uint32_t> first;  // of the actor's lasts, by action
    for (auto [i, end] = packed.edges_of(p); i < end; ++i) {
      const auto uses = taken_by(packed, p, i).uses;
      if (steps_[p][i].is_kept || uses.empty() || uses.front().model != model) continue;
      const std::uint32_t action = is_known ? action_number(actions, uses.front()) : no_action;
      const auto [place, is_new] =
          first.try_emplace(action, static_cast<std::uint32_t>(lasts_.size()));
      steps_[p][i] = {model, action, place->second};
      if (!is_new) continue;
      if (!is_known) {
        lasts_.push_back({0, model, p});
        continue;
      }
      MAIDE_CHECK(action < actions.size() && commuting[action].size() == states);
      for (StateId at = 0; at < states; ++at) {
        MAIDE_CHECK(place->second + at == lasts_.size());  // found by its state
        lasts_.push_back({commuting[action][at], model, p});
      }
    }
  }
}

}  // namespace maide
