// The global state graph of a system in Aldebaran's format .aut (CADP, mCRL2, LTSmin): a state for
// each reachable one before any cut, a transition for each step, labelled by its action ("planner
// via?write"; step_action.hpp). Where a run leaves what was learned, its step is a self-loop that
// ends in "beyond", so that no such state looks like a deadlock. A state without a transition is a
// deadlock, or all programs have ended there.
#pragma once

#include <cstdint>
#include <iosfwd>

#include "maide/base/run_control.hpp"
#include "maide/check/system.hpp"

namespace maide {

struct GraphSize {
  std::uint64_t states = 0, transitions = 0;
};

// The graph is walked twice, because its size stands in the first line: once to number its states,
// breadth first, once to write. Memory: some 16 bytes a state, 8 more for each further 64 bits that
// a state needs. Throws Interrupted, or Error (inconclusive) if more than `bytes` are needed.
GraphSize write_aut(std::ostream& out, const System& system, std::uint64_t bytes,
                    const RunControl& control);

}  // namespace maide
