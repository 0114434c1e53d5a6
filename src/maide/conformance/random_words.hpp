// Random words: independent, each of a random length and random inputs. Finds what is wrong in many
// places; says little about what it does not find.
#pragma once

#include "maide/base/random.hpp"
#include "maide/conformance/test_runner.hpp"
#include "maide/conformance/test_suite.hpp"

namespace maide {

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

class RandomWords : public EquivalenceOracle {
 public:
  // Keeps a reference to `oracle`. Each equivalence query draws new words. Throws UsageError if the
  // lengths are no range.
  explicit RandomWords(OutputOracle& oracle, RandomWordsOptions options = {});

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override { return guarantee_; }
  Strength strength() const override { return strength_; }

 private:
  TestRunner runner_;
  RandomWordsOptions options_;
  Random random_;
  std::string guarantee_ = "not tested";
  Strength strength_;
};

}  // namespace maide
