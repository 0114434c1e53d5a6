// Loops that are sure to end: over a container that the body does not name, and those that count a
// local number up or down to a bound that nothing in the body changes.
#pragma once

#include "maide/extract/sources.hpp"

namespace maide::extract {

bool is_finite_loop(const Statement& loop, const Sources& sources);

}  // namespace maide::extract
