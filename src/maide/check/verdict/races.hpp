// Which connections race: what is sent later may come first. No property is needed for that.
//
// Take two messages to one process, and say that A's was sent before B's. The connection B
// overtakes the connection A if on some run the process takes B's while A's is still on its way.
// "Sent before" is Lamport's relation ("Time, clocks, and the ordering of events in a distributed
// system", CACM 1978). The sender of B's message has sent A's itself, or it has heard from who did,
// over any number of programs. Messages whose senders know nothing of one another have no order.
//
// The race is suspicious if the process, before A's message arrives, looks for it and finds
// nothing: it takes a step that it could not take had the message arrived.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/search/search.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct Race {
  std::string later, earlier;            // "the answer of lookup", "map"
  std::string reader;                    // the program or node that takes `earlier`
  std::optional<SourcePosition> missed;  // where it finds nothing; none: it never does
};

struct Races {
  std::vector<Race> all;     // the suspicious ones first
  bool is_complete = true;   // false: a limit ended the search, and there may be more
  bool has_unknown = false;  // of some models it is not known what they hold
  std::uint64_t states = 0;  // of the system, with what is watched
};

// Whether anything is late; if not, nothing races.
bool has_late_messages(const System& system);

// Searches the reachable states breadth first. In each, any message that is put on a wire may be
// the one that is watched; then the search knows who has heard from its sender, and which messages
// were sent by those. Such a search has more states than the system. O(states x steps).
Races find_races(const System& system, const SearchLimits& limits);

// A line each, at most ten, and then how many more there are; and what was not looked at.
std::vector<std::string> describe_races(const Races& races);

}  // namespace maide
