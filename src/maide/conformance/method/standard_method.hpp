// The tests of `maide learn` unless others are asked for. A hypothesis must agree with everything
// observed so far, which costs nothing. Then it must pass these suites, each only if the one before
// found nothing:
//
//   growth    guesses that a row of states goes on (loop_suites.hpp); few words
//   random    2000 + 20 n k tests for n states and k inputs, of several laws (InfixSampler), in
//             turn with hybrid ADS (complete_method.hpp) for one extra state. n k tests come alone
//             before; they refute most hypotheses on the way
//   deeper    two and three extra states where they cost at most 5,000 tests. Three stand in for
//             most of the random tests: queues of the middleware have some 20 states and 5 inputs
//   chains    in every state every word of three inputs that loop there
//   pumps     in every state every looping input repeated, then each other input
//   samples   chains behind other ways into a state; ladders, where something is counted; and what
//             chains and pumps leave out
//
// So the cheap suites run for every hypothesis. The dear ones run only for those that nothing cheap
// refutes: as a rule, the last. `strength()` says how far they came. `cost_of_missing()` says what
// the rest would cost where the budget did not pay for all. docs/testing.md has the machines on
// which the constants were chosen, and what these tests cannot see.
//
// A long counterexample is shortened before the learner sees it, but for one of growth, which shows
// many states at once.
//
// The av translation spreads a step over several symbols, so the same difference lies deeper. There
// a random walk follows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/random_words.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"

namespace maide {

struct StandardMethodOptions {
  std::size_t extra_states = 3;  // at most, unless more are demanded
  std::optional<std::uint64_t> max_tests =
      {};                                     // of one equivalence query, in place of the budget's
  TestCost budget = {1'000'000, 30'000'000};  // of one equivalence query
  std::string strength = {};            // what to reach, as parse_demand() reads it; or the default
  std::vector<std::size_t> sizes = {};  // the numbers that the system's options name
  std::uint64_t seed = 0;
  std::size_t batch_size = TestRunnerOptions{}.batch_size;
};

class StandardMethod : public EquivalenceOracle {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if the strength is none.
  explicit StandardMethod(OutputOracle& oracle, StandardMethodOptions options = {});

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override { return guarantee_; }
  Strength strength() const override { return strength_; }
  TestCost cost_of_missing() const override { return missing_; }

 private:
  class Query;

  OutputOracle& oracle_;
  StandardMethodOptions options_;
  Random random_;
  std::vector<Word> counterexamples_;  // of all tests so far, for random ones to replay
  RandomWalk random_walk_;
  std::string guarantee_ = "not tested";
  Strength strength_;
  TestCost missing_;
};

// A shorter counterexample, by words behind an access word of the hypothesis and by leaving inputs
// out (A. Zeller & R. Hildebrandt, "Simplifying and isolating failure-inducing input", IEEE TSE
// 2002), cut at the first output that differs; `word`, if none is found. At most
// `most_queries` output queries. `word` must be a counterexample cut in the same way.
Word shorten_counterexample(OutputOracle& oracle, const Mealy& hypothesis, Word word,
                            std::uint64_t most_queries, const RunControl& control);

}  // namespace maide
