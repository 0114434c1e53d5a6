// A run of a system that an engine shows: an alarm's proof. It is never shown before it was
// replayed on the system's own semantics.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "maide/check/system.hpp"

namespace maide {

struct Trace {
  std::vector<Step> steps;  // from the initial state
  // Steps from here on repeat for ever. None: the run ends there, is cut, or need not be shown any
  // further because whatever comes violates the property.
  std::optional<std::size_t> loop_start;
};

// The states along the trace, one more than steps. Throws std::logic_error if a step is not
// possible where it is taken, or the loop does not close.
std::vector<GlobalState> replay(const System& system, const Trace& trace);

// Whether the formula holds at each position of the run: position 0 is the initial state, position
// i the state after i steps; a run that ends has one more, at which it repeats its last state
// without the event that led there. `states` are replay()'s.
std::vector<bool> evaluate_on_run(const System& system, const Formula& formula, const Trace& trace,
                                  const std::vector<GlobalState>& states);

// Whether the trace is what it claims to be: it replays and shows that `property` does not hold - a
// deadlock, a fair run that violates the formula, or a prefix that no run can make good. Returns
// what is wrong with it, "" if nothing is.
std::string find_flaw(const System& system, const Property& property, const Trace& trace);

}  // namespace maide
