// Finds the smallest changes that remove a violation: another model for one connection, other
// settings of a middleware, another value of a constant, another number of repetitions. A change is
// named only after the native engine has checked the system with it and everything holds. Models
// for other settings are learned for that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/explore/check_system.hpp"
#include "maide/check/language/system.hpp"
#include "maide/check/language/system_file.hpp"

namespace maide {

// ---- Variants ----
//
// A system with something changed: other numbers behind `repeat` and other constants in its text,
// another model behind an instance. The rest stays as it was read. What is learned with an option
// that is a constant's value is learned anew if that is another.

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
};

// Nothing if there is no such system: its model lacks an input that programs give, its `repeat` is
// not where it should be, or the file is wrong with that constant. `learn` makes the models that
// are then learned with other options; without `learn` there are none.
std::optional<System> make_variant(const System& system, const SystemVariant& variant,
                                   const ModelSource& learn = {}, const RunControl& control = {});

struct SuggestOptions {
  ModelSource models;                                 // learns the models of other settings
  std::function<void(const std::string& line)> note;  // told what could not be tried, and why
  RunControl control;
  double seconds_each = 10;  // most time to check one change
};

struct Suggestions {
  std::vector<std::string> changes;  // one line each, the ones that leave the programs alone first
  std::size_t tried = 0;             // systems that were checked
};

// Tries these changes, one at a time:
//
//   Other models: those beside the ones in use, and those in use elsewhere in the system.
//   Settings that keep more (depth, history, reliability, ...): the smallest number that is enough.
//   Other values of constants: the nearest ones that are enough.
//   Fewer repetitions wherever a number stands: the largest number that is few enough.
//   One number of repetitions in place of another.
//
// `before` is the report of the system as it is: the same properties are checked. An interruption
// ends the search with what was found.
Suggestions suggest_changes(const System& system, const CheckReport& before,
                            const SuggestOptions& options);

}  // namespace maide
