#include "maide/automata/words.hpp"

#include <algorithm>
#include <utility>

namespace maide {

Word joined(Word word, const Word& suffix) {
  word.insert(word.end(), suffix.begin(), suffix.end());
  return word;
}

Word head(const Word& word, std::size_t length) {
  return {word.begin(), word.begin() + static_cast<std::ptrdiff_t>(length)};
}

Word tail(const Word& word, std::size_t start) {
  return {word.begin() + static_cast<std::ptrdiff_t>(start), word.end()};
}

std::size_t count_common(std::span<const Symbol> left, std::span<const Symbol> right) {
  return static_cast<std::size_t>(std::ranges::mismatch(left, right).in1 - left.begin());
}

bool is_prefix(const Word& prefix, const Word& word) {
  return prefix.size() <= word.size() && std::equal(prefix.begin(), prefix.end(), word.begin());
}

// Sorted, a word comes right before one that goes on from it, if there is any.
std::vector<Word> without_prefixes(std::vector<Word> words) {
  std::sort(words.begin(), words.end());
  std::vector<Word> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool goes_on = i + 1 < words.size() && is_prefix(words[i], words[i + 1]);
    if (!goes_on) kept.push_back(std::move(words[i]));
  }
  return kept;
}

}  // namespace maide
