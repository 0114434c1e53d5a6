// Counts of learners, and what is reported of runs that end early.
#include "learner_bench.hpp"

#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "published_results.hpp"

namespace maide {
namespace {

std::vector<BenchModel> random_models(std::size_t count) {
  std::vector<BenchModel> models;
  for (std::size_t i = 0; i < count; ++i) {
    Random random(i);
    models.push_back({"random-" + std::to_string(i), minimize(random_mealy({6, 3, 2}, random))});
  }
  return models;
}

TEST(LearnerBench, HandsRunsOverInTheOrderOfModelsAndAlgorithms) {
  const std::vector<BenchModel> models = random_models(8);
  BenchOptions options;
  options.algorithms = {"lsharp", "rs"};
  options.jobs = 4;
  std::vector<BenchRun> runs;
  EXPECT_TRUE(run_bench(models, options, [&](const BenchRun& run) { runs.push_back(run); }));
  ASSERT_EQ(runs.size(), 16U);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(runs[i].model, i / 2);
    EXPECT_EQ(runs[i].algorithm, options.algorithms[i % 2]);
    EXPECT_EQ(runs[i].outcome, BenchOutcome::right) << runs[i].error;
  }
}

// Somebody presses Ctrl-C while the third run is being reported: nothing behind it is begun, what
// was measured stays.
TEST(LearnerBench, KeepsWhatWasMeasuredWhenItIsStopped) {
  const std::vector<BenchModel> models = random_models(8);
  BenchOptions options;
  options.algorithms = {"rs"};
  options.jobs = 1;
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::size_t runs = 0;
  EXPECT_FALSE(run_bench(
      models, options,
      [&](const BenchRun&) {
        if (++runs == 3) stop.request_stop();
      },
      control));
  EXPECT_EQ(runs, 3U);
}

TEST(LearnerBench, PassesOnWhatItsListenerThrows) {
  const std::vector<BenchModel> models = random_models(8);
  BenchOptions options;
  options.jobs = 3;
  const auto fail = [](const BenchRun&) {
    throw Error(ExitStatus::inconclusive, "the disk is full");
  };
  EXPECT_THROW(run_bench(models, options, fail), Error);
}

TEST(LearnerBench, RefusesUnknownNamesBeforeAnythingIsRun) {
  const auto none = [](const BenchRun&) { FAIL(); };
  BenchOptions algorithm, method;
  algorithm.algorithms = {"x"};
  method.test_method = "x";
  EXPECT_THROW(run_bench(random_models(1), algorithm, none), UsageError);
  EXPECT_THROW(run_bench(random_models(1), method, none), UsageError);
}

TEST(LearnerBench, AnAlgorithmThatIsNamedTwiceCountsOnce) {
  BenchOptions options;
  options.algorithms = {"rs", "lsharp", "rs"};
  const std::vector<const LearnerEntry*> algorithms = bench_learners(options);
  ASSERT_EQ(algorithms.size(), 2U);
  EXPECT_EQ(algorithms[1]->name, "lsharp");
  EXPECT_EQ(bench_learners({}).size(), deterministic_learners().size());
}

TEST(PeerFigures, AreFoundByNamesInAlphabeticalOrder) {
  EXPECT_FALSE(are_the_41_models({}));
  const std::vector<std::string> some{"BitVise", "DropBear"};
  EXPECT_FALSE(are_the_41_models(some));
  for (const PeerRun& run : peer_runs()) EXPECT_GT(run.symbols, run.resets) << run.model;
}

}  // namespace
}  // namespace maide
