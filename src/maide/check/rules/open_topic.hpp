// What a reader sees of a topic that anybody alone writes. What he wrote, and when, nobody knows,
// so there is nothing to remember: a message may be there whenever somebody looks, and may not.
#pragma once

#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"

namespace maide {

// A `read` is taken, and any message may come from then on; a `tryread` brings one, or `null`.
// Messages are "message", or "message(go)" for each value. One state, and one behind each input.
InterfaceAutomaton make_open_topic(const std::vector<std::string>& values, bool has_tryread);

}  // namespace maide
