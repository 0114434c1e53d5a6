// Partial-order reduction. In each state a set of programs is chosen whose steps are enough:
// whatever the other programs do first does not disturb these steps, and is not disturbed by them.
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
// Example: two programs that write to a queue each: one of them alone is such a set. Where both
// write to one queue, which has a single place left, it is not: the other's write takes the place.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "maide/check/packed/packed_system.hpp"
#include "maide/check/reduce/commutation.hpp"

namespace maide {

// Sets of programs, by bit, among which nobody counts as the last; a system of more is not reduced.
inline constexpr std::size_t most_reduced_programs = 64;

struct StubbornOptions {
  Commutation::Watch watch = Commutation::Watch::nothing;
  // Edges, and actions of nobody, that must not be in a set unless all is: by actor, by edge.
  // Empty: none but those into an error.
  std::vector<std::vector<bool>> visible;
  bool cuts_are_visible = false;  // steps that cut the run must not be in such a set, either
  bool singletons = false;        // one program, or all
};

class StubbornSets {
 public:
  // Keeps a reference. Does nothing (select() returns what can step) for a system of more than
  // most_reduced_programs programs.
  StubbornSets(const PackedSystem& packed, StubbornOptions options);

  // The programs whose steps are to be explored; all that can step where no set is smaller. A bit
  // may stand for a program that cannot step. Not
  // thread-safe, since answers about models are kept: threads have copies.
  template <std::size_t words>
  std::uint64_t select(const PackedState<words>& state) {
    if (programs_.size() > most_reduced_programs) return ~std::uint64_t{0};
    for (std::size_t p = 0; p < programs_.size(); ++p) control_[p] = packed_.control(state, p);
    for (std::size_t m = 0; m < models_.size(); ++m) at_[m] = packed_.model_state(state, m);
    return select_here();
  }
  // The last answer leaves out a program that can step.
  bool is_reduced() const { return is_reduced_; }

 private:
  // What a step does with one model.
  struct Use {
    std::uint32_t model = 0;
    std::uint32_t action = 0;  // of the model
  };
  struct Next {
    std::uint32_t first_use = 0, use_count = 0;  // in the program's `uses`
    bool is_visible = false;
  };
  struct ReducedProgram {
    std::vector<std::uint32_t> first;  // in `next`, by control state, one more than states
    std::vector<Next> next;            // as Program::edges
    std::vector<Use> uses;
    std::vector<std::uint32_t> first_use;  // in `uses`, by control state, one more than states
    std::vector<std::uint32_t> models;     // that it uses
    std::vector<std::uint64_t> future;     // actions that may come, by control state and `models`
    std::span<const Use> uses_of(const Next& one) const {
      return std::span(uses).subspan(one.first_use, one.use_count);
    }
  };
  struct User {
    std::uint32_t program = 0;
    std::uint32_t slot = 0;  // in the program's `models`
  };
  struct ReducedModel {
    Commutation commutation;
    std::vector<User> users;
  };
  // What a program can do now.
  struct Now {
    std::uint32_t steps = 0;
    bool is_visible = false;
  };

  void add_program(std::size_t index, const std::vector<std::vector<ModelUse>>& actions);
  // One control state, in which whatever nobody may ever do comes next.
  void add_nobody(const std::vector<std::vector<ModelUse>>& actions);
  void add_next(std::size_t index, std::span<const ModelUse> uses, bool is_visible,
                const std::vector<std::vector<ModelUse>>& actions);
  static void compute_future(const Program& program, ReducedProgram& reduced);
  Now look_at(std::size_t program) const;
  std::uint64_t select_here();
  // The least closed set with `program`; 0 if it is more than one program and may not be.
  std::uint64_t closure(std::size_t program);
  // The programs outside `set` to be added, so that the use is undisturbed.
  std::uint64_t disturbers(const Use& use, std::uint64_t set);
  std::uint64_t future_of(const User& user) const;

  const PackedSystem& packed_;
  StubbornOptions options_;
  std::vector<ReducedProgram> programs_;
  std::vector<ReducedModel> models_;
  std::vector<ControlState> control_;  // of the state looked at
  std::vector<StateId> at_;
  std::vector<Now> now_;
  bool is_reduced_ = false;
};

}  // namespace maide
