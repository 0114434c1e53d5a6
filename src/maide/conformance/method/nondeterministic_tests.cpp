#include "maide/conformance/method/nondeterministic_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace maide {
namespace {

constexpr std::size_t portion = 50;  // words between two looks at the samples

}  // namespace

// The transition cover, each word followed by all words of extra_states + 1 inputs; or so many of
// these, drawn at random, as may be run.
std::vector<Word> NondeterministicTests::covering_words() {
  const auto inputs = static_cast<Symbol>(samples_.inputs().size());
  std::vector<Word> words = learner_.transition_cover();
  for (std::size_t step = 0; step <= options_.extra_states; ++step) {
    random_.shuffle(words);
    if (words.size() > options_.max_tests) words.resize(options_.max_tests);
    std::vector<Word> longer;
    for (const Word& word : words) {
      for (Symbol input = 0; input < inputs; ++input) {
        longer.push_back(word);
        longer.back().push_back(input);
      }
    }
    words = std::move(longer);
  }
  random_.shuffle(words);
  if (words.size() > options_.max_tests) words.resize(options_.max_tests);
  return words;
}

std::vector<Word> NondeterministicTests::random_words() {
  std::vector<Word> words(options_.random_words);
  for (Word& word : words) {
    word.resize(random_.between(1, 2 * learner_.hypothesis().size() + 5));
    for (Symbol& input : word) input = static_cast<Symbol>(random_.below(samples_.inputs().size()));
  }
  return words;
}

bool NondeterministicTests::is_refuted(const RunControl& control) {
  guarantee_ = "not tested to the end";
  const std::vector<Word> random = random_words();
  samples_.run(random, control);
  if (learner_.find_mismatch()) return true;
  const std::vector<Word> covering = covering_words();
  for (std::size_t start = 0; start < covering.size(); start += portion) {
    const auto first = covering.begin() + static_cast<std::ptrdiff_t>(start);
    const std::size_t size = std::min(portion, covering.size() - start);
    samples_.sample({first, first + static_cast<std::ptrdiff_t>(size)}, control);
    if (learner_.find_mismatch()) return true;
  }
  guarantee_ = fmt::format(
      "not refuted by {} words of the transition cover and {} inputs more, each place asked {} "
      "times, and {} random words",
      covering.size(), options_.extra_states + 1, samples_.needed(), random.size());
  return false;
}

}  // namespace maide
