// Callbacks whose code may go round for ever, and spins that may wait for ever for an answer while
// callbacks run: what that keeps from going on `stuck` does not look at. A loop in the text is not
// enough for that: it is asked whether some strongly fair run stays in it.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "maide/check/system/system.hpp"

namespace maide {

// Lines of the text with such loops and such spins, by program. O(edges).
struct EndlessLines {
  std::set<int> loops, spins;
};
std::map<std::uint32_t, EndlessLines> find_endless_callbacks(const System& system);

// That on strongly fair runs the program comes again and again out of the code of callbacks; or,
// where it spins, out of the spin. A system with more labels, and the property.
struct EndlessQuestion {
  System system;
  Property property;
};
EndlessQuestion ask_whether_endless(const System& system, std::uint32_t program, bool spins);

// What is not looked at, in one line.
std::string describe_endless(const EndlessLines& lines);

}  // namespace maide
