// Callbacks whose code may go round for ever: what their threads and groups keep from starting then
// `stuck` does not look at. A loop in the text is not enough for that: it is asked whether some
// strongly fair run stays in it.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "maide/check/system/system.hpp"

namespace maide {

// Lines of the text with such loops, by program. O(edges).
std::map<std::uint32_t, std::set<int>> find_endless_callbacks(const System& system);

// That on strongly fair runs the program is again and again in the code of no callback: a system
// with one more label, and the property.
struct EndlessQuestion {
  System system;
  Property property;
};
EndlessQuestion ask_whether_endless(const System& system, std::uint32_t program);

std::string describe_endless(const std::set<int>& lines);

}  // namespace maide
