// The one way to ask what can come next in a system: its initial state, the steps of a state, those
// with an event, what a step is called, and the step that led to a state. Searches use nothing else
// to go from state to state.
//
// There are two implementations. StepsByTheBook, here, follows the meaning (system.hpp) word by
// word, and is slow. PackedSteps (packed/packed_steps.hpp) reads tables, and is what searches take.
// A test holds them equal, on each state and in the order of the steps.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>

#include "maide/check/system/system.hpp"

namespace maide {

// A step, as a person sees it. Two steps that are possible in one state may have the same text: a
// model that is nondeterministic then goes to different states.
struct StepText {
  std::string actor;  // the program's name; "" for nobody
  int line = 0;       // in the system file; 0: none
  std::string model;  // "" if it gives nothing and takes nothing, or from several
  // "?input", "!output", "?input!output", "quiet", or "if" and "else"; of other steps their text in
  // the file.
  std::string event;
  bool operator==(const StepText&) const = default;
};
StepText describe_step(const System& system, const Step& step);

// Which steps are asked for. What is not given is any.
struct WantedSteps {
  std::optional<std::uint32_t> actor;  // or nobody
  std::optional<ModelUse> event;       // an input that is given, or an output that is taken
};
bool is_wanted(const System& system, const Step& step, const WantedSteps& wanted);

// A step that led to a state, and the state before it.
struct StepBefore {
  Step step;
  GlobalState before;
};

// What both implementations have. Actors are numbered: programs as in the system, then nobody, if
// he has actions, in one part or several. `code`: with the state after a step it tells the step and
// the state before it.
//
//   for_each_of(state, actor, visit)   Calls visit(next, action, is_cut, code).
//   for_each(state, visit)             Calls visit(next, actor, action, is_cut, code).
//   by_event(state, wanted, visit)     Does what for_each() does, for the steps that are wanted.
//
// for_each() and by_event() give nothing where a program is at an error.
template <typename Steps>
concept NextSteps = requires(
    const Steps& steps, const typename Steps::State& state, const WantedSteps& wanted,
    void (*of_one)(const typename Steps::State&, std::uint32_t, bool, std::uint64_t),
    void (*of_any)(const typename Steps::State&, std::size_t, std::uint32_t, bool, std::uint64_t)) {
  { steps.system() } -> std::same_as<const System&>;
  { steps.actors() } -> std::same_as<std::size_t>;
  { steps.initial() } -> std::same_as<typename Steps::State>;
  steps.for_each_of(state, std::size_t{0}, of_one);
  steps.for_each(state, of_any);
  steps.by_event(state, wanted, of_any);
  { steps.text(Step()) } -> std::same_as<StepText>;
  { steps.undo(state, std::uint64_t{0}) } -> std::same_as<StepBefore>;
};

class StepsByTheBook {
 public:
  using State = GlobalState;

  // Keeps a reference.
  explicit StepsByTheBook(const System& system) : system_(&system) {}

  const System& system() const { return *system_; }
  std::size_t actors() const { return actor_count(*system_); }
  State initial() const { return initial_state(*system_); }

  template <typename Visit>
  void for_each_of(const State& state, std::size_t actor, Visit&& visit) const {
    const bool is_program = actor < system_->programs.size();
    const std::uint32_t who = is_program ? static_cast<std::uint32_t>(actor) : nobody;
    for (const Step& step : enabled_steps(*system_, state, who)) {
      visit(apply(*system_, state, step), step.action, step.is_cut, code_of(state, step));
    }
  }
  template <typename Visit>
  void for_each(const State& state, Visit&& visit) const {
    by_event(state, {}, visit);
  }
  template <typename Visit>
  void by_event(const State& state, const WantedSteps& wanted, Visit&& visit) const {
    for (const Step& step : enabled_steps(*system_, state)) {
      if (!is_wanted(*system_, step, wanted)) continue;
      visit(apply(*system_, state, step), actor_number(*system_, step.actor), step.action,
            step.is_cut, code_of(state, step));
    }
  }

  StepText text(const Step& step) const { return describe_step(*system_, step); }

  // The code has all that is not in the state after the step: the actor, the action, whether the
  // step is beyond what was learned and cut there, and where each model was that it uses.
  std::uint64_t code_of(const State& before, const Step& step) const;
  StepBefore undo(const State& state, std::uint64_t code) const;

 private:
  std::size_t most_actions() const;

  const System* system_;
};
static_assert(NextSteps<StepsByTheBook>);

}  // namespace maide
