// What is still on its way at the end of a run, and when it was sent: what a late message explains.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

// "a message from mapper to map, sent at step 1", "2 messages from left to scan[log], the first
// sent at step 3", "a request of robot to lookup, sent at step 2": in the order of the models.
// `states` are replay()'s. O(steps x wires).
std::vector<std::string> find_on_its_way(const System& system, const Trace& trace,
                                         const std::vector<GlobalState>& states);

}  // namespace maide
