#include "maide/conformance/random_words.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "maide/base/error.hpp"

namespace maide {

bool RandomWordSuite::next(Word& word) {
  word.resize(random_.between(min_length_, max_length_));
  for (Symbol& input : word) input = static_cast<Symbol>(random_.below(inputs_));
  return true;
}

RandomWords::RandomWords(OutputOracle& oracle, RandomWordsOptions options)
    : runner_(oracle, {options.max_tests, options.batch_size}),
      options_(options),
      random_(options.seed) {
  if (options.min_length == 0 ||
      (options.max_length != 0 && options.max_length < options.min_length)) {
    throw UsageError(fmt::format("random words of length {} to {} cannot be", options.min_length,
                                 options.max_length));
  }
  constexpr std::size_t longest = 1'000'000;
  if (std::max(options.min_length, options.max_length) > longest) {
    throw UsageError(fmt::format("random words of more than {} inputs are too long", longest));
  }
}

std::optional<Word> RandomWords::find_counterexample(const Mealy& hypothesis,
                                                     const RunControl& control) {
  const std::size_t max_length = options_.max_length != 0
                                     ? options_.max_length
                                     : std::max(2 * hypothesis.size() + 10, options_.min_length);
  RandomWordSuite suite(hypothesis.inputs().size(), options_.min_length, max_length,
                        random_.split());
  guarantee_ = "not tested to the end";
  strength_ = {};
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  guarantee_ = counterexample ? "refuted by a random word"
                              : fmt::format("not refuted by {} random words of length {} to {}",
                                            runner_.last_tests(), options_.min_length, max_length);
  if (!counterexample) strength_.random = runner_.last_tests();
  return counterexample;
}

}  // namespace maide
