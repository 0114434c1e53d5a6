// Random machines that hide something: most inputs do nothing, and a few rare ones in a row, or one
// often enough, lead on. Uniform random machines (random_automata.hpp) hide nothing, so a learner's
// tests pass on them that miss most of a real protocol. The same seed gives the same machine
// everywhere; every state is reachable, and no two states are equivalent.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"

namespace maide {

enum class Hiding : std::uint8_t {
  pairs,     // levels, each left by two rare inputs in a row; a third shows where one is
  triples,   // the same by three in a row
  counters,  // one input so many times in a row, then another shows it; a second count may follow
  login,     // a password of three words, behind it a random machine
  sinks,     // a long way on which every wrong step ends in one of a few sinks for ever
  modes,     // one input turns through modes that answer alike but for a rare input each
  layers,    // random machines, each left from one state only, by one rare input
  nothing,   // a uniform random machine
};

std::span<const std::string_view> hiding_names();  // in the order above
// Throws UsageError that lists the known ones.
Hiding find_hiding(std::string_view name);

// A machine that hides something so, minimal, of about `states` states (at least 4, for counters
// at most 64) and `inputs` inputs (at least 4). Throws UsageError for less. O(states x inputs).
Mealy hiding_mealy(Hiding hiding, std::size_t states, std::size_t inputs, Random& random);

}  // namespace maide
