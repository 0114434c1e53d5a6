// "Did you mean ...?": the known name nearest to a misspelt one, by the number of insertions,
// deletions, substitutions and transpositions of neighbours (F. Damerau, "A technique for computer
// detection and correction of spelling errors", CACM 1964).
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace maide {

// The number of edits that turn `a` into `b`; O(|a| |b|).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The nearest of `known` (the first of them in case of a tie), or "" if none is near: more than a
// third of the name's letters, and more than one, would have to change.
std::string find_nearest(std::string_view name, std::span<const std::string> known);

// "; did you mean 'depth'?", or "" if nothing is near. To be put behind an error message.
std::string did_you_mean(std::string_view name, std::span<const std::string> known);

}  // namespace maide
