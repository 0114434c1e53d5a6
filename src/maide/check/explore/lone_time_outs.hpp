// Time-outs that hide a program that waits in vain: selects that, from some point of some run on,
// only their time-outs end, because whatever happens then, none of their other arms can be taken
// again. Without its time-out such a program would be stuck, or in a deadlock. A select that is
// `idle` may wait in vain.
//
// The reachable states are searched once, by Tarjan's components (Tarjan, "Depth-first search and
// linear graph algorithms", SIAM J. Comput. 1972), path-based. A component knows which arms can be
// taken in it and behind it. Beyond what was learned any arm may come. O(states + steps); nothing
// is searched where no select has a time-out.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/check/explore/search.hpp"
#include "maide/check/language/system.hpp"

namespace maide {

// A select of a program's text: one in all rounds of its loops and copies of its procedure.
struct LoneTimeOut {
  std::uint32_t program = 0;
  std::vector<ProgramEdge> arms;  // that are waited for in vain
};

// Some select has a time-out. O(steps of programs).
bool has_time_outs(const System& system);

// In the order of the programs and their texts. None if the limits end the search.
std::vector<LoneTimeOut> find_lone_time_outs(const System& system, const SearchLimits& limits);

}  // namespace maide
