#include "maide/conformance/method/known_words.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {
namespace {

class ListedSuite : public TestSuite {
 public:
  explicit ListedSuite(const std::vector<Word>& words) : words_(words) {}
  bool next(Word& word) override {
    if (next_ == words_.size()) return false;
    word = words_[next_++];
    return true;
  }
  std::optional<std::uint64_t> size() const override { return words_.size(); }

 private:
  const std::vector<Word>& words_;
  std::size_t next_ = 0;
};

}  // namespace

std::optional<Word> KnownWords::find_counterexample(const Mealy& hypothesis,
                                                    const RunControl& control) {
  ListedSuite suite(words_);
  return runner_.run(suite, hypothesis, control);
}

std::string KnownWords::guarantee() const {
  return fmt::format("right about {} word{} that earlier models gave", words_.size(),
                     words_.size() == 1 ? "" : "s");
}

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
