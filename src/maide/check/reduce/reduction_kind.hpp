// Which parts of a system's graph a search may leave out, by name (`--reduction`). A verdict is the
// same with each of them. reduction.hpp has the rules, docs/design/reductions.md why they are
// right.
#pragma once

#include <cstdint>
#include <string>

namespace maide {

enum class Reduction : std::uint8_t {
  none,
  calls,  // an input and the output that answers it are one step
  order,  // partial-order reduction: of steps that do not disturb one another one order is enough
  full,   // both, and states with a single step are passed by
};
std::string to_string(Reduction reduction);
// Throws UsageError.
Reduction reduction_of(const std::string& name);
bool merges_calls(Reduction reduction);
bool leaves_out_orders(Reduction reduction);

}  // namespace maide
