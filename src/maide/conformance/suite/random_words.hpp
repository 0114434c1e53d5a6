// Random words, as tests: independent ones of random lengths, and a random walk that is cut into
// words by resets. They find what is wrong in many places, and say little about what they do not
// find.
#pragma once

#include <cstdint>
#include <optional>

#include "maide/base/random.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

// Independent words, each of a random length and random inputs.
class RandomWordSuite : public TestSuite {
 public:
  // Endless. Lengths are uniform in [min_length, max_length].
  RandomWordSuite(std::size_t inputs, std::size_t min_length, std::size_t max_length, Random random)
      : inputs_(inputs), min_length_(min_length), max_length_(max_length), random_(random) {}

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  std::size_t inputs_, min_length_, max_length_;
  Random random_;
};

struct RandomWordsOptions {
  std::uint64_t max_tests = 1000;  // in one equivalence query
  std::size_t min_length = 1;
  std::size_t max_length = 0;  // 0: twice the states of the hypothesis, and 10
  std::uint64_t seed = 0;
  std::size_t batch_size = TestRunnerOptions{}.batch_size;
};

class RandomWords : public SuiteMethod {
 public:
  // Keeps a reference to `oracle`. Each equivalence query draws new words. Throws UsageError if the
  // lengths are no range.
  explicit RandomWords(OutputOracle& oracle, RandomWordsOptions options = {});

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;

 private:
  RandomWordsOptions options_;
  Random random_;
};

// A random walk: random inputs, and a reset after each with a certain probability. Each piece
// between two resets is a test, so lengths are geometrically distributed.
class RandomWalkSuite : public TestSuite {
 public:
  // Ends after `steps` inputs in all. No piece is longer than `max_length`.
  RandomWalkSuite(std::size_t inputs, double restart_probability, std::size_t max_length,
                  std::uint64_t steps, Random random)
      : inputs_(inputs),
        restart_probability_(restart_probability),
        max_length_(max_length),
        steps_left_(steps),
        random_(random) {}

  bool next(Word& word) override;
  // Not known before the walk is over.
  std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  std::size_t inputs_;
  double restart_probability_;
  std::size_t max_length_;
  std::uint64_t steps_left_;
  Random random_;
};

struct RandomWalkOptions {
  double restart_probability = 0.05;
  std::uint64_t max_steps = 10000;  // in one equivalence query
  std::size_t max_length = 1000;    // of a piece
  std::uint64_t max_tests = TestRunnerOptions{}.max_tests;
  std::uint64_t seed = 0;
  std::size_t batch_size = TestRunnerOptions{}.batch_size;
};

class RandomWalk : public SuiteMethod {
 public:
  // Keeps a reference to `oracle`. Each equivalence query walks anew. Throws UsageError unless the
  // probability lies in [0, 1] and lengths are at least 1.
  explicit RandomWalk(OutputOracle& oracle, RandomWalkOptions options = {});

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;

 private:
  RandomWalkOptions options_;
  Random random_;
};

}  // namespace maide
