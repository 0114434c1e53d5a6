// Which actions of one model disturb one another: worked out from its automaton, beforehand.
//
// An action is what program edges do with the model: give an input, take an output, see that it is
// quiet, or do one of its own actions. Action `a` is undisturbed in state x by a set B of actions
// if in every state y that B can lead to from x, and for every action b of B that is possible in y,
//   - `a` is possible in y exactly if it is possible after b;
//   - what b and then `a` can lead to, `a` and then b can lead to as well;
//   - after every outcome of `a`, every outcome of b is still there, and the two meet in one state.
// So whatever others do with B first, `a` could as well have come first; and `a` may come first
// without taking anything from them. These are conditions D1 and D2 of stubborn sets (Valmari,
// "Stubborn sets for reduced state space generation", 1989), for one model, nondeterminism
// included. A read and a write on a queue that is neither empty nor full satisfy them.
// On an empty queue they do not: before the write there is nothing to read.
//
// With fairness the run in which `a` comes first must also be treated as fairly: see Watch.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

// What programs and nobody do with each model, by model: each action once.
std::vector<std::vector<ModelUse>> find_actions(const System& system);
// The number of the use among the actions of its model; their count if it is none of them.
std::uint32_t action_number(const std::vector<ModelUse>& actions, const ModelUse& use);

class Commutation {
 public:
  // What else must be kept in which `a` comes first.
  enum class Watch : std::uint8_t {
    nothing,
    // Weak fairness: `a` makes no action of B possible, or only such as were possible in none of
    // the states before it: who was disabled again and again still is. A call (merged_calls.hpp)
    // disturbs all, and is disturbed by all, since others cannot step in the middle of it.
    weak,
    // Strong fairness: `a` makes no action of B possible at all.
    strong,
  };

  // `actions`: at most 64. `strongly_fair`: those that are watched as with strong fairness, by bit.
  // Reads the model, keeps nothing of it.
  Commutation(const ModelInstance& model, const std::vector<ModelUse>& actions, Watch watch,
              std::uint64_t strongly_fair = 0);

  // Whether `b` does not disturb `a` in that one state, fairness aside: see above. True if `b` is
  // not possible.
  bool commute(std::size_t a, std::size_t b, StateId at) const;

  // By state: whether `action` is undisturbed there by the actions in `others`, a set of bits.
  // O(transitions of `action` and `others`) for each set.
  const std::vector<std::uint8_t>& undisturbed(std::size_t action, std::uint64_t others);
  // By state: whether `others` may lead to where `action` is possible, or it is so there. The same
  // cost.
  const std::vector<std::uint8_t>& may_come(std::size_t action, std::uint64_t others);

 private:
  struct Outcome {
    StateId target = 0;
    bool is_cut = false;  // the run ends there; the model stays where it is
    auto operator<=>(const Outcome&) const = default;
  };
  using States = std::vector<std::uint8_t>;  // by state: whether it is one of them
  // Where an action leads from, by target: those from first[target] up to first[target + 1].
  struct Sources {
    std::vector<std::uint32_t> first;
    std::vector<StateId> states;
  };
  using Answers = std::vector<std::unordered_map<std::uint64_t, States>>;  // by action, `others`

  bool is_possible(std::size_t action, StateId at) const { return !outcomes_[action][at].empty(); }
  bool makes_possible(std::size_t a, std::size_t b, StateId at) const;
  bool is_disturbed(std::size_t a, std::size_t b, StateId at) const;
  void find_sources(std::size_t action);
  // By state: whether `b` disturbs `a` in it. Worked out once for each two.
  const States& disturbed(std::size_t a, std::size_t b);
  // Adds all states from which `others` can lead to one that is marked.
  void spread_backwards(States& marked, std::uint64_t others) const;
  // Under weak fairness: adds the states before which some b was possible, if `action` makes b
  // possible.
  void add_enabled(std::size_t action, std::uint64_t others, States& disturbed) const;
  States find_undisturbed(std::size_t action, std::uint64_t others);
  States find_coming(std::size_t action, std::uint64_t others);
  using Question = States (Commutation::*)(std::size_t, std::uint64_t);
  const States& answer(Answers& known, Question question, std::size_t action, std::uint64_t others);

  std::size_t states_;
  Watch watch_;
  std::uint64_t strongly_fair_;
  std::vector<bool> is_call_;                                // by action
  std::vector<std::vector<std::vector<Outcome>>> outcomes_;  // by action, by state; sorted
  std::vector<Sources> sources_;                             // by action
  std::vector<std::optional<States>> disturbed_;             // by two actions
  Answers undisturbed_, coming_;
};

}  // namespace maide
