// Which parts of a system's graph may be left out when a property is asked of it, and what has to
// be kept for that: see docs/design/reductions.md for why.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "maide/check/stubborn_sets.hpp"
#include "maide/check/system.hpp"

namespace maide {

enum class Reduction : std::uint8_t {
  none,
  order,  // partial-order reduction: of steps that do not disturb one another one order is enough
  full,   // and states with a single step are passed by
};
std::string to_string(Reduction reduction);
// Throws UsageError.
Reduction reduction_of(const std::string& name);

// What a search must respect when it takes the steps of stubborn sets only.
struct ReductionRules {
  StubbornOptions sets;
  bool puts_nothing_off = false;  // steps that are left out are taken in some later state
};

ReductionRules rules_for_deadlock();
// For a run that leaves what was learned.
ReductionRules rules_for_cut();
// Nothing if the formula could see where silent steps lie (silent_steps.hpp): then all is taken.
std::optional<ReductionRules> rules_for_invariant(const System& system, const Property& property);
// For `stuck`, or a formula with the property's fairness.
std::optional<ReductionRules> rules_for_cycle(const System& system, const Property& property);

}  // namespace maide
