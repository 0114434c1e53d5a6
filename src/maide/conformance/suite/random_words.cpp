#include "maide/conformance/suite/random_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "maide/base/error.hpp"

namespace maide {

bool RandomWordSuite::next(Word& word) {
  word.resize(random_.between(min_length_, max_length_));
  for (Symbol& input : word) input = static_cast<Symbol>(random_.below(inputs_));
  return true;
}

RandomWords::RandomWords(OutputOracle& oracle, RandomWordsOptions options)
    : SuiteMethod(oracle, {options.max_tests, options.batch_size}),
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
  return run(suite, hypothesis, control, "a random word", [&](std::uint64_t tests) -> Passed {
    return {fmt::format("not refuted by {} random words of length {} to {}", tests,
                        options_.min_length, max_length),
            {.random = tests}};
  });
}

bool RandomWalkSuite::next(Word& word) {
  word.clear();
  while (steps_left_ > 0 && word.size() < max_length_) {
    word.push_back(static_cast<Symbol>(random_.below(inputs_)));
    --steps_left_;
    if (random_.chance(restart_probability_)) break;
  }
  return !word.empty();
}

RandomWalk::RandomWalk(OutputOracle& oracle, RandomWalkOptions options)
    : SuiteMethod(oracle, {options.max_tests, options.batch_size}),
      options_(options),
      random_(options.seed) {
  if (!(options.restart_probability >= 0 && options.restart_probability <= 1)) {
    throw UsageError(fmt::format("the restart probability {} is not between 0 and 1",
                                 options.restart_probability));
  }
  if (options.max_length == 0) throw UsageError("a random walk needs a length of at least 1");
}

std::optional<Word> RandomWalk::find_counterexample(const Mealy& hypothesis,
                                                    const RunControl& control) {
  RandomWalkSuite suite(hypothesis.inputs().size(), options_.restart_probability,
                        options_.max_length, options_.max_steps, random_.split());
  return run(suite, hypothesis, control, "a random walk", [&](std::uint64_t tests) -> Passed {
    return {fmt::format("not refuted by a random walk of at most {} steps, {} restarts",
                        options_.max_steps, tests),
            {.random = tests}};
  });
}

}  // namespace maide
