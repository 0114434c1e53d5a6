#include "maide/conformance/confirmation_words.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/random.hpp"
#include "maide/conformance/separating_words.hpp"

namespace maide {
namespace {

Word joined(Word word, const Word& suffix) {
  word.insert(word.end(), suffix.begin(), suffix.end());
  return word;
}

// The words that are no prefixes of others, none twice; sorted.
std::vector<Word> without_prefixes(std::vector<Word> words) {
  std::sort(words.begin(), words.end());
  std::vector<Word> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool goes_on = i + 1 < words.size() && words[i].size() <= words[i + 1].size() &&
                         std::equal(words[i].begin(), words[i].end(), words[i + 1].begin());
    if (!goes_on && !words[i].empty()) kept.push_back(std::move(words[i]));
  }
  return kept;
}

}  // namespace

std::vector<Word> choose_confirmation_words(const Mealy& model, std::uint64_t seed,
                                            std::uint64_t most_symbols) {
  Random random(seed);
  std::vector<Word> suffixes = compute_characterising_set(model, SeparatingWords(model));
  if (suffixes.empty()) suffixes.emplace_back();
  std::vector<Word> words;
  for (const Word& access : compute_state_cover(model)) {
    for (const Word& suffix : suffixes) words.push_back(joined(access, suffix));
    for (Symbol input = 0; input < model.inputs().size(); ++input) {
      words.push_back(joined(joined(access, {input}), suffixes[random.below(suffixes.size())]));
    }
  }
  words = without_prefixes(std::move(words));
  random.shuffle(words);
  std::uint64_t symbols = 0;
  std::size_t taken = 0;
  while (taken < words.size()) {
    symbols += words[taken].size();
    if (taken > 0 && symbols > most_symbols) break;
    ++taken;
  }
  words.resize(taken);
  return words;
}

}  // namespace maide
