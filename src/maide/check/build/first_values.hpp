// Shared variables that have any value at first: `var x: 0..3 = any;`. A program that the file does
// not write chooses all values of a component in one step, before any other program of it does
// anything.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

// `variables`: their models. Throws ParseError where they have too many values together.
// O(edges of the programs' first control states, and combinations of values).
void choose_first_values(System& system, const std::vector<std::uint32_t>& variables);

}  // namespace maide
