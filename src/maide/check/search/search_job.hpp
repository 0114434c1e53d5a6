// What a rank needs to take part in another one's search (ranks.hpp): the system, as far as
// its states and steps go, and what is looked for.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "maide/check/reduce/reduction_kind.hpp"
#include "maide/check/search/monitors.hpp"
#include "maide/check/search/ranks.hpp"
#include "maide/check/search/search.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct SearchJob {
  enum class Goal : std::uint8_t {
    none,  // there are no more searches
    deadlock,
    error,
    cut,
    invariant,  // a position at which it does not hold
    cycle,      // a fair cycle that a monitor accepts
  };
  // The monitor of a search for a cycle.
  struct Monitor {
    StreettAutomaton automaton;                // of runs that violate a formula
    StuckRuns stuck = StuckRuns::weakly_fair;  // the runs on which somebody is stuck
    bool has_wide_bits = false;
  };
  Goal goal = Goal::none;
  System system;      // without what only messages need
  Property property;  // of an invariant, or a cycle
  Reduction reduction = Reduction::none;
  SearchLimits limits;  // states and depth are those of all ranks together, the others of each
  Monitor monitor;
};

// Both ways; ranks run the same program on machines of one kind. Throws UsageError for bytes of
// another version.
Ranks::Bytes encode(SearchJob job);
// A number that two jobs share if their searches find the same, whatever their limits but depth.
std::uint64_t key_of(SearchJob job);
SearchJob decode(std::span<const unsigned char> bytes);

// Searches the system breadth-first for that goal, with checkpoints if the limits name a folder for
// them. With ranks, on all of them, which have the same result. If the search of a rank fails, that
// is one line, and all ranks end. For cycles there must be ranks (fair_hull.hpp).
SearchResult explore(const System& system, SearchJob::Goal goal, const Property& property,
                     Reduction reduction, const SearchLimits& limits,
                     const SearchJob::Monitor& monitor = {});

}  // namespace maide
