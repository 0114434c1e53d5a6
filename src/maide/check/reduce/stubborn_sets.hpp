// Partial-order reduction. In each state a set of actors, programs and parts of nobody, is chosen
// whose steps are enough: whatever the others do first does not disturb these steps, and is not
// disturbed by them.
//
// Programs meet on models only. So a set is closed by a question for each program in it and each of
// its next actions: does all that programs outside may ever do with that model leave the action
// undisturbed (commutation.hpp)? If not, the program that disturbs it is taken in. A blocked
// program in the set needs no rule of its own: its action is undisturbed if no program outside can
// make it possible. A step that uses several models is disturbed where one of its uses is: it is
// possible exactly where all of them are, and what it does to one model does not depend on others.
//
// These are strong stubborn sets (Valmari, "Stubborn sets for reduced state space generation",
// 1989), or persistent sets (Godefroid, "Partial-order methods for the verification of concurrent
// systems", 1996), in units of programs. What else must hold, visibility and cycles, depends on the
// property: see docs/design/reductions.md.
//
// What is on its way to an empty mailbox that one program waits for is such a set alone: nothing
// that happens first can tell whether it has arrived. What a part of nobody may ever do is all that
// it has, but nothing as long as its wire is empty and nobody can put anything on it.
//
// Example: two programs that write to a queue each: one of them alone is such a set. Where both
// write to one queue, which has a single place left, it is not: the other's write takes the place.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maide/check/packed/packed_system.hpp"
#include "maide/check/reduce/commutation.hpp"

namespace maide {

struct StubbornOptions {
  Commutation::Watch watch = Commutation::Watch::nothing;
  // Edges, and actions of nobody, that must not be in a set unless all is: by actor, by edge.
  // Empty: none but those into an error.
  std::vector<std::vector<bool>> visible;
  bool cuts_are_visible = false;  // steps that cut the run must not be in such a set, either
  bool one_can_step = false;      // no two actors of the set, unless it is all
};

class StubbornSets {
 public:
  // Keeps a reference. Does nothing (select() returns what can step) for a system of more than
  // most_actors_in_a_word programs.
  StubbornSets(const PackedSystem& packed, StubbornOptions options);

  // The actors whose steps are to be explored; all that can step where no set is smaller. A set
  // that is smaller has a step that is due: it is progress, and if the search is for fair runs,
  // they take it or another one of its actor if it stays possible. Not thread-safe, since answers
  // about models are kept: threads have copies.
  template <std::size_t words>
  std::uint64_t select(const PackedState<words>& state) {
    if (actors_.size() > most_actors_in_a_word) return ~std::uint64_t{0};
    for (std::size_t a = 0; a < actors_.size(); ++a) control_[a] = packed_.control(state, a);
    for (std::size_t m = 0; m < models_.size(); ++m) at_[m] = packed_.model_state(state, m);
    for (std::size_t a = 0; a < actors_.size(); ++a) now_[a] = look_at(state, a);
    return select_here();
  }
  // The last answer leaves out an actor that can step.
  bool is_reduced() const { return is_reduced_; }

 private:
  // What a step does with one model.
  struct Use {
    std::uint32_t model = 0;
    std::uint32_t action = 0;  // of the model
  };
  struct Next {
    std::uint32_t first_use = 0, use_count = 0;  // in the actor's `uses`
    bool is_visible = false;
    bool is_due = true;
  };
  struct ReducedActor {
    std::uint32_t first_edge = 0;  // of `next`
    std::vector<Next> next;        // as Program::edges, or the part's actions of nobody
    std::vector<Use> uses;
    std::vector<std::uint32_t> first_use;  // in `uses`, by control state, one more than states
    std::vector<std::uint32_t> models;     // that it uses
    std::vector<std::uint64_t> future;     // actions that may come, by control state and `models`
    std::span<const Use> uses_of(const Next& one) const {
      return std::span(uses).subspan(one.first_use, one.use_count);
    }
  };
  struct User {
    std::uint32_t actor = 0;
    std::uint32_t slot = 0;  // in the actor's `models`
  };
  struct ReducedModel {
    std::optional<Commutation> commutation;  // none: what disturbs what is not known
    std::vector<User> users;
  };
  // What an actor can do now.
  struct Now {
    std::uint32_t steps = 0;
    bool is_visible = false;
    bool is_due = false;  // one of the steps
  };

  std::vector<std::uint64_t> find_strongly_fair(
      const std::vector<std::vector<ModelUse>>& actions) const;
  void add_program(std::size_t index, const std::vector<std::vector<ModelUse>>& actions);
  // Fair runs take one of its actions again and again if this one stays possible.
  bool is_due(const NobodysAction& action, std::size_t part) const;
  // One control state, in which whatever that part of nobody may ever do comes next.
  void add_part(std::size_t index, const std::vector<std::vector<ModelUse>>& actions);
  void add_next(std::size_t index, std::span<const ModelUse> uses, bool is_visible, bool is_due,
                const std::vector<std::vector<ModelUse>>& actions);
  static void compute_future(const Program& program, ReducedActor& reduced);
  template <std::size_t words>
  Now look_at(const PackedState<words>& state, std::size_t actor) const {
    Now now;
    const auto& next = actors_[actor].next;
    packed_.for_each_step(
        state, actor,
        [&](const PackedState<words>&, std::uint32_t edge, bool is_cut, std::uint64_t) {
          const Next& one = next[edge - actors_[actor].first_edge];
          ++now.steps;
          now.is_visible =
              now.is_visible || one.is_visible || (is_cut && options_.cuts_are_visible);
          now.is_due = now.is_due || one.is_due;
        });
    return now;
  }
  std::uint64_t select_here();
  // Parts of nobody of which some action may come.
  void find_coming();
  bool may_come(const Use& use);
  // The least closed set with `actor`; 0 if it may not be chosen.
  std::uint64_t closure(std::size_t actor);
  // The actors outside `set` to be added, so that the use is undisturbed.
  std::uint64_t disturbers(const Use& use, std::uint64_t set);
  // Actions of its model that may come.
  std::uint64_t future_of(const User& user) const;

  const PackedSystem& packed_;
  StubbornOptions options_;
  std::vector<ReducedActor> actors_;
  std::vector<ReducedModel> models_;
  std::vector<ControlState> control_;  // of the state looked at
  std::vector<StateId> at_;
  std::vector<Now> now_;
  std::uint64_t idle_ = 0;  // parts of nobody of which no action may come
  bool is_reduced_ = false;
};

}  // namespace maide
