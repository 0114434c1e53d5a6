// The steps of a system from its tables (system/steps.hpp): what searches ask for what comes next.
// A view of a PackedSystem, for states of so many words.
#pragma once

#include <cstddef>
#include <cstdint>

#include "maide/check/packed/packed_system.hpp"
#include "maide/check/system/steps.hpp"

namespace maide {

template <std::size_t words>
class PackedSteps {
 public:
  using State = PackedState<words>;

  // Keeps a reference.
  explicit PackedSteps(const PackedSystem& packed) : packed_(&packed) {}

  const PackedSystem& packed() const { return *packed_; }
  const System& system() const { return packed_->system(); }
  std::size_t actors() const { return packed_->actor_count(); }
  State initial() const { return packed_->pack<words>(initial_state(system())); }

  // Not in a state that is an error. `is_plain`: the system has_plain_steps_only().
  template <bool is_plain = false, typename Visit>
  [[gnu::always_inline]] void for_each_of(const State& state, std::size_t actor,
                                          Visit&& visit) const {
    packed_->for_each_step<is_plain>(state, actor, visit);
  }
  template <typename Visit>
  void for_each(const State& state, Visit&& visit) const {
    if (packed_->is_error(state)) return;
    for (std::size_t actor = 0; actor < actors(); ++actor) {
      for_each_of(state, actor,
                  [&](const State& next, std::uint32_t action, bool is_cut, std::uint64_t code) {
                    visit(next, actor, action, is_cut, code);
                  });
    }
  }
  template <typename Visit>
  void by_event(const State& state, const WantedSteps& wanted, Visit&& visit) const {
    for_each(state, [&](const State& next, std::size_t actor, std::uint32_t action, bool is_cut,
                        std::uint64_t code) {
      Step step;
      step.actor = actor < packed_->program_count() ? static_cast<std::uint32_t>(actor) : nobody;
      step.action = action;
      if (is_wanted(system(), step, wanted)) visit(next, actor, action, is_cut, code);
    });
  }

  StepText text(const Step& step) const { return describe_step(system(), step); }
  StepBefore undo(const State& state, std::uint64_t code) const {
    return packed_->undo(packed_->unpack(state), code);
  }

 private:
  const PackedSystem* packed_;
};
static_assert(NextSteps<PackedSteps<1>>);

}  // namespace maide
