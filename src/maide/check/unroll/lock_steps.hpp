// What a program does with mutexes that know who holds them, and with conditions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/rules/locks.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide::program_syntax {

class LockSteps {
 public:
  // `number`: of the program. Keeps references.
  LockSteps(std::uint32_t number, ModelActions& actions, const Names& names)
      : number_(number), actions_(actions), names_(names) {}

  bool is_condition(std::uint32_t model) const { return names_.conditions.contains(model); }
  // The input of a mutex that knows its holder, as this program gives it; none: it is another's.
  std::optional<ModelUse> given(std::uint32_t model, Symbol input);
  // The same, with the answer that follows at once.
  std::optional<ModelUse> given(std::uint32_t model, Symbol input, Symbol answer);
  // Where the input is an error, and which.
  struct Error {
    ModelUse where;
    std::string text;
  };
  std::optional<Error> error_of(std::uint32_t model, Symbol input);

  // A run on one of several threads ends. Who runs next is not known, so the run is cut where a
  // mutex is kept that knows its holder.
  Uses end_run();
  // The mutex of the condition is taken; and the event.
  std::pair<ModelUse, ModelUse> relock(std::uint32_t condition);
  // It is given back, and the program waits; and the events.
  std::pair<Uses, Uses> wait(std::uint32_t condition);
  Error error_of_wait(std::uint32_t condition);
  // It waits no more.
  ModelUse wake(std::uint32_t condition, WaiterStep step);

 private:
  ModelUse hold(std::uint32_t mutex, HolderStep step);
  // `lock` or `unlock` of a mutex of any kind.
  ModelUse use_of(std::uint32_t mutex, const char* input);
  ModelUse event_of(std::uint32_t model, const char* input) const;

  std::uint32_t number_ = 0;
  ModelActions& actions_;
  const Names& names_;
};

}  // namespace maide::program_syntax
