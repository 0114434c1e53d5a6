#include "maide/check/unroll/lock_steps.hpp"

#include <algorithm>

#include "maide/base/invariant.hpp"

namespace maide::program_syntax {
namespace {

std::size_t place_of(std::uint32_t program, const std::vector<std::uint32_t>& programs) {
  const auto place = std::ranges::find(programs, program);
  MAIDE_CHECK(place != programs.end());
  return static_cast<std::size_t>(place - programs.begin());
}

std::string text_of(HolderStep step) {
  switch (step) {
    case HolderStep::lock: return "lock";
    case HolderStep::unlock: return "unlock";
    case HolderStep::trylock: return "trylock";
    case HolderStep::trylock_yes: return "trylock -> yes";
    case HolderStep::trylock_no: return "trylock -> no";
    case HolderStep::locks_once_more: return "lock once more";
    case HolderStep::is_not_holder: return "no lock";
  }
  return "";
}

std::string text_of(WaiterStep step) {
  return step == WaiterStep::wait ? "waits" : step == WaiterStep::wake ? "wakes" : "waits no more";
}

}  // namespace

ModelUse LockSteps::hold(std::uint32_t mutex, HolderStep step) {
  const std::vector<std::uint32_t>& holders = names_.holders.at(mutex);
  const std::size_t place = place_of(number_, holders), count = holders.size();
  return actions_.action(mutex, text_of(step) + " of user " + std::to_string(place + 1),
                         ModelActions::StepsOfState([step, place, count](StateId at) {
                           return holder_steps(at, step, count, place);
                         }));
}

std::optional<ModelUse> LockSteps::given(std::uint32_t model, Symbol input) {
  if (!names_.holders.contains(model)) return std::nullopt;
  constexpr HolderStep steps[] = {HolderStep::lock, HolderStep::unlock, HolderStep::trylock};
  return hold(model, steps[input]);
}

std::optional<ModelUse> LockSteps::given(std::uint32_t model, Symbol input, Symbol answer) {
  if (actions_.automaton(model).inputs().name(input) != "trylock") return std::nullopt;
  return hold(model, answer == 0 ? HolderStep::trylock_yes : HolderStep::trylock_no);
}

std::optional<LockSteps::Error> LockSteps::error_of(std::uint32_t model, Symbol input) {
  if (!names_.holders.contains(model)) return std::nullopt;
  const std::string& name = actions_.model(model).name;
  if (actions_.automaton(model).inputs().name(input) == "unlock") {
    return Error{hold(model, HolderStep::is_not_holder), name + " is unlocked by another"};
  }
  return Error{hold(model, HolderStep::locks_once_more),
               name + " is locked more than " + std::to_string(max_depth_of_lock) + " times"};
}

Uses LockSteps::end_run() {
  Uses uses;
  for (const auto& [mutex, holders] : names_.holders) {
    const auto own = std::ranges::find(holders, number_);
    if (own == holders.end()) continue;
    const auto place = static_cast<std::size_t>(own - holders.begin());
    uses.push_back(
        actions_.action(mutex, "user " + std::to_string(place + 1) + " ends a run",
                        ModelActions::StepsOfState([place, count = holders.size()](StateId at) {
                          return std::vector<ModelStep>{{at, holds_mutex(at, count, place)}};
                        })));
  }
  return uses;
}

ModelUse LockSteps::event_of(std::uint32_t model, const char* input) const {
  return {ModelUse::Kind::give, model, *actions_.model(model).automaton.inputs().find(input)};
}

ModelUse LockSteps::use_of(std::uint32_t mutex, const char* input) {
  const ModelUse event = event_of(mutex, input);
  return given(mutex, event.index).value_or(event);
}

std::pair<ModelUse, ModelUse> LockSteps::relock(std::uint32_t condition) {
  const std::uint32_t mutex = names_.conditions.at(condition).mutex;
  return {use_of(mutex, "lock"), event_of(mutex, "lock")};
}

std::pair<Uses, Uses> LockSteps::wait(std::uint32_t condition) {
  const std::uint32_t mutex = names_.conditions.at(condition).mutex;
  return {{wake(condition, WaiterStep::wait), use_of(mutex, "unlock")},
          {event_of(condition, "wait"), event_of(mutex, "unlock")}};
}

LockSteps::Error LockSteps::error_of_wait(std::uint32_t condition) {
  const std::uint32_t mutex = names_.conditions.at(condition).mutex;
  const std::string text =
      actions_.model(condition).name + ".wait: " + actions_.model(mutex).name + " is not locked";
  const ModelUse unlock = use_of(mutex, "unlock");
  if (names_.holders.contains(mutex)) return {hold(mutex, HolderStep::is_not_holder), text};
  return {*actions_.idle(mutex, {unlock}), text};
}

ModelUse LockSteps::wake(std::uint32_t condition, WaiterStep step) {
  const std::size_t place = place_of(number_, names_.conditions.at(condition).waiters);
  return actions_.action(condition, text_of(step) + ", of waiter " + std::to_string(place + 1),
                         ModelActions::StepsOfState(
                             [step, place](StateId at) { return waiter_steps(at, step, place); }));
}

}  // namespace maide::program_syntax
