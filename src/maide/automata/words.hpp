// What is done with words everywhere.
#pragma once

#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

// `word`, then `suffix`.
Word joined(Word word, const Word& suffix);

// Every word is a prefix of itself.
bool is_prefix(const Word& prefix, const Word& word);

// The words that are no prefixes of others, none twice; sorted. O(n log n) comparisons.
std::vector<Word> without_prefixes(std::vector<Word> words);

}  // namespace maide
