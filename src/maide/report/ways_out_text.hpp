// Sentences about programs that wait in a `select`, for an answer, or in another place with several
// ways out (verdict/ways_out.hpp): who would make one possible, and why he does not.
#pragma once

#include <string>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/verdict/waiting.hpp"

namespace maide {

// "a", "a and b", "a, b and c".
std::string list_words(const std::vector<std::string>& words, const std::string& last = " and ");

// Of a program that waits for one of several steps: "w would make acked == true, but has ended;
// a.timeout would make late true, but is in the group of a.waiter, which waits".
std::string describe_ways_out(const System& system, const Waiting& waiting);

}  // namespace maide
