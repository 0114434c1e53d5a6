// What is done with words everywhere.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

// `word`, then `suffix`.
Word joined(Word word, const Word& suffix);

// The first `length` symbols.
Word head(const Word& word, std::size_t length);

// From the symbol number `start` on.
Word tail(const Word& word, std::size_t start);

// Length of the longest common prefix. O(that length).
std::size_t count_common(std::span<const Symbol> left, std::span<const Symbol> right);

// Every word is a prefix of itself.
bool is_prefix(const Word& prefix, const Word& word);

// The words that are no prefixes of others, none twice; sorted. O(n log n) comparisons.
std::vector<Word> without_prefixes(std::vector<Word> words);

}  // namespace maide
