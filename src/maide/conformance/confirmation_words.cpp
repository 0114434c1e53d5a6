#include "maide/conformance/confirmation_words.hpp"

#include <utility>
#include <vector>

#include "maide/automata/words.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/separating_words.hpp"

namespace maide {

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
  std::erase(words, Word());
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
