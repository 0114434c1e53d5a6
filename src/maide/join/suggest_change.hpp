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
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/system_variant.hpp"

namespace maide {

struct SuggestOptions {
  ModelSource models;                                 // learns the models of other settings
  std::function<void(const std::string& line)> note;  // told what could not be tried, and why
  // Why a property of a changed system is violated, in a sentence; none: that is not told.
  std::function<std::string(const System& system, const PropertyResult& result)> explain;
  RunControl control;
  double seconds_each = 10;  // most time to check one change
};

struct Suggestions {
  std::vector<std::string> changes;  // one line each, the ones that leave the programs alone first
  // If none removes all: those that make one violated property hold, and break none.
  std::map<std::string, std::string> in_part;  // by property
  // If there is none for the property either: one with which it is violated from another cause
  // alone, which is told. By property.
  std::map<std::string, std::string> of_one_cause;
  std::size_t tried = 0;  // systems that were checked
};

// Tries these changes, one at a time. Those come first that touch the cause of a violation
// (check/verdict/cause.hpp): groups and threads of the nodes that keep somebody from waking who
// waits, and the depth of what lost a message that is waited for. Then, where the violation needs a
// message that comes late or is lost on its way (join/late_changes.hpp): waiting for its arrival,
// asking again, waiting in place of one look, and a writer that keeps more. Then at large:
//
//   Other models: those beside the ones in use, and those in use elsewhere in the system.
//   Settings that keep more (depth, history, reliability, ...): the smallest number that is enough.
//   Other values of constants: the nearest ones that are enough.
//   Another callback group for a client or a callback of a node, an executor with more threads.
//   Longer queues of services, topics and models that are written by hand: the shortest.
//   Where none of these is enough: one depth for several queues.
//   Fewer repetitions wherever a number stands: the largest number that is few enough.
//   One number of repetitions in place of another.
//
// `before` is the report of the system as it is: the same properties are checked. An interruption
// ends the search with what was found.
Suggestions suggest_changes(const System& system, const CheckReport& before,
                            const SuggestOptions& options);

}  // namespace maide
