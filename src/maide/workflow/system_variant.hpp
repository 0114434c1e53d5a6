// A system with something changed: other numbers behind `repeat` in its text, another model behind
// an instance. The rest stays as it was read; nothing is learned again.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/system.hpp"

namespace maide {

// A `repeat` of a program.
struct Repeat {
  int line = 0, column = 0;  // in the system file
  std::uint32_t count = 0;
};

// Those of the programs that stand in the system file, in the order of the file.
std::vector<Repeat> find_repeats(const System& system);

struct SystemVariant {
  std::vector<Repeat> repeats;                       // with their new counts
  std::map<std::string, InterfaceAutomaton> models;  // by instance
};

// Nothing if there is no such system: a model without an input that programs give, a `repeat` that
// is not where it should be.
std::optional<System> make_variant(const System& system, const SystemVariant& variant);

}  // namespace maide
