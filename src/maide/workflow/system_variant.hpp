// A system with something changed: other numbers behind `repeat` and other constants in its text,
// another model behind an instance. The rest stays as it was read. What is learned with an option
// that is a constant's value is learned anew if that is another.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/language/system.hpp"
#include "maide/check/language/system_file.hpp"

namespace maide {

// A `repeat` of a program.
struct Repeat {
  int line = 0, column = 0;  // in the system file
  std::uint32_t count = 0;
};

// Those of the programs that stand in the system file, in the order of the file.
std::vector<Repeat> find_repeats(const System& system);

// A number under `constants:`.
struct NumberConstant {
  std::string name;
  int line = 0, column = 0;  // of its value, in the system file
  std::int64_t value = 0;
};

// Those that are written as numbers, in the order of the file.
std::vector<NumberConstant> find_constants(const System& system);

struct SystemVariant {
  std::vector<Repeat> repeats;                       // with their new counts
  std::map<std::string, InterfaceAutomaton> models;  // by instance
  std::vector<NumberConstant> constants;             // with their new values
  std::string text{};                                // of the whole file; empty: as it was read
};

// Nothing if there is no such system: its model lacks an input that programs give, its `repeat` is
// not where it should be, or the file is wrong with that constant. `learn` makes the models that
// are then learned with other options; without `learn` there are none.
std::optional<System> make_variant(const System& system, const SystemVariant& variant,
                                   const ModelSource& learn = {}, const RunControl& control = {});

}  // namespace maide
