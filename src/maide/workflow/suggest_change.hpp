// The smallest changes that remove a violation: another model for one connection, other settings of
// a middleware, another number of repetitions in the programs. Nothing is guessed: a change is
// named only after the system with it was checked, by the native engine, and everything holds -
// with models that are learned for it where that is what changes.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/check_system.hpp"
#include "maide/check/system_file.hpp"

namespace maide {

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

// Tries, one at a time: the other models that lie beside those in use and the ones in use elsewhere
// in the system; settings that keep more (depth, history, reliability, ...), the smallest number of
// each that is enough; fewer repetitions wherever a number stands, the largest that is few enough;
// one number in place of another. `before` is the report of the system as it is: the same
// properties are checked. An interruption ends the search with what was found.
Suggestions suggest_changes(const System& system, const CheckReport& before,
                            const SuggestOptions& options);

}  // namespace maide
