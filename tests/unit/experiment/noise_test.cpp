// Whole runs on systems that do not always do the same: noise is voted down, what is no noise is
// said to be nondeterministic, and without either a run costs not one symbol more.
#include <gtest/gtest.h>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/learner.hpp"
#include "maide/sul/simulated_sul.hpp"
#include "noisy_sul.hpp"

namespace maide {
namespace {

InterfaceAutomaton reference() {
  return read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/strict-2.dot");
}

struct NoisyRun {
  ExperimentResult result;
  std::uint64_t disturbed = 0;
  bool is_right = false;
};

NoisyRun learn_beside_noise(const test::NoiseOptions& noise, ExperimentOptions options) {
  SimulatedSul quiet(reference(), "sim");
  test::NoisySul sul(quiet, noise);
  IaTranslator translator(sul, Translation::eager);
  NoisyRun run;
  run.result = run_experiment(translator, options);
  if (run.result.error) std::rethrow_exception(run.result.error);
  run.disturbed = sul.disturbed();
  run.is_right = compare(translator.to_interface_automaton(run.result.model), reference()).same();
  return run;
}

class NoisyLearning : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, NoisyLearning, testing::Values("rs", "lmplus"),
                         [](const auto& entry) { return entry.param; });

TEST_P(NoisyLearning, TheMajorityIsRightForEverySeed) {
  std::uint64_t contradictions = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    ExperimentOptions options;
    options.algorithm = GetParam();
    options.testing.seed = seed;
    options.confirm = true;
    const NoisyRun lost = learn_beside_noise({.lost = 0.03, .seed = seed}, options);
    EXPECT_TRUE(lost.is_right) << "seed " << seed << ", lost outputs";
    const NoisyRun flipped = learn_beside_noise({.flipped = 0.02, .seed = seed}, options);
    EXPECT_TRUE(flipped.is_right) << "seed " << seed << ", flipped outputs";
    EXPECT_GT(flipped.disturbed, 0U);
    contradictions += lost.result.contradictions.size() + flipped.result.contradictions.size();
  }
  EXPECT_GT(contradictions, 20U);
}

TEST(Noise, AKeptCacheIsCorrectedToo) {
  const TempDir folder;
  ExperimentOptions options;
  options.confirm = true;
  options.cache_file = folder.path() / "cache";
  const NoisyRun first = learn_beside_noise({.lost = 0.05, .seed = 3}, options);
  EXPECT_TRUE(first.is_right);
  EXPECT_GT(first.result.restarts, 0U);
  const NoisyRun again = learn_beside_noise({.lost = 1, .seed = 3}, options);
  EXPECT_TRUE(again.is_right);
  EXPECT_EQ(again.result.experiments, 0U);
}

TEST(Noise, WithoutItARunCostsWhatItDid) {
  for (const LearnerEntry& algorithm : deterministic_learners()) {
    ExperimentOptions options;
    options.algorithm = algorithm.name;
    const NoisyRun plain = learn_beside_noise({}, options);
    EXPECT_EQ(plain.result.statistics.at(LearnPhase::confirmation), QueryCounts());
    EXPECT_TRUE(plain.result.contradictions.empty());
    options.confirm = true;
    const NoisyRun confirmed = learn_beside_noise({}, options);
    EXPECT_EQ(confirmed.result.restarts, 0U);
    // A fresh query for each counterexample, and nothing else.
    const QueryCounts cost = confirmed.result.statistics.at(LearnPhase::confirmation);
    EXPECT_EQ(cost.queries, confirmed.result.equivalence_queries - 1);
    EXPECT_EQ(confirmed.result.symbols - cost.symbols, plain.result.symbols);
  }
}

TEST(Noise, WhatComesHalfOfTheTimeIsNone) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_THROW(learn_beside_noise({.lost = 0.5, .seed = seed}, {}), NondeterminismError) << seed;
  }
}

}  // namespace
}  // namespace maide
