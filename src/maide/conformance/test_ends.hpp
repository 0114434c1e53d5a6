// What stands around the infix of a random test: how the state is drawn in which it begins, and by
// which word it ends. The field's choices: LearnLib draws states and words alike; AALpy can begin
// in the states that lie far away; tests of a transition cover begin behind a transition.
#pragma once

#include <cstdint>
#include <string_view>

namespace maide {

// Where a test begins.
enum class PrefixStates : std::uint8_t {
  uniform,  // in each state of the hypothesis alike
  // In the farther of two states drawn alike: what was found last mostly lies deep, and behind it
  // what is still to be found.
  deep,
  transitions,  // behind a transition, each alike: a random state's word and a random input
};

// How a test ends.
enum class SuffixWords : std::uint8_t {
  own,   // by a word that identifies the state reached
  any,   // by a word that identifies a random state: other words than a complete suite has there
  none,  // at once: what an infix shows in its own outputs, for the fewest inputs
};

struct TestEnds {
  PrefixStates prefix = PrefixStates::uniform;
  SuffixWords suffix = SuffixWords::own;
};

// "uniform", "deep", "transitions"; throws UsageError that lists them.
PrefixStates find_prefix_states(std::string_view name);
// "own", "any", "none"; likewise.
SuffixWords find_suffix_words(std::string_view name);

}  // namespace maide
