// A few words that show again, one by one, what a learned model rests on: each state, told from the
// others, and each transition, with a word that identifies where it leads. For a second look at the
// system under other conditions, not for finding new states.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide {

// State cover with a characterising set, transition cover with a word of it drawn for each
// transition; no word is a prefix of another. Of these a sample of at most `most_symbols` inputs in
// all, but at least one word. `model` must be complete; the same seed gives the same words.
std::vector<Word> choose_confirmation_words(const Mealy& model, std::uint64_t seed,
                                            std::uint64_t most_symbols);

}  // namespace maide
