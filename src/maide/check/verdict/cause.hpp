// The cause of a violation: who waits in the end, or for ever, who could wake whom, and what keeps
// him from it. Causes of two runs can be compared, also of a system and of one that was changed a
// little: they have names and no numbers.
#pragma once

#include <compare>
#include <optional>
#include <set>
#include <string>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/ways_out.hpp"

namespace maide {

// Somebody, a callback or a program, would wake the one who waits, and cannot.
struct Hindrance {
  std::string waiting, helper;
  Obstacle obstacle = Obstacle::none;  // own_thread, own_group, no_thread or busy
  auto operator<=>(const Hindrance&) const = default;
};

struct Cause {
  std::set<Hindrance> hindrances;
  std::set<std::string> nodes;   // of the helpers, and of what has the threads and groups they need
  std::set<std::string> losing;  // services and models at which somebody waits, and that lost
};

// Of those who never step again on the run, or cannot in its last state.
Cause find_cause(const System& system, const Trace& trace);

}  // namespace maide
