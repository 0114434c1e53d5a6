// Laws that every learner obeys, over all small machines and over random ones: it reaches the
// minimal machine, within the query bounds of its paper, the same with a cache and without, and its
// invariants hold before every equivalence query.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <tuple>

#include "learner_names.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "small_machines.hpp"

namespace maide {
namespace {

// Remembers the longest counterexample.
class MeasuringTeacher : public EquivalenceOracle {
 public:
  explicit MeasuringTeacher(EquivalenceOracle& teacher) : teacher_(teacher) {}
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control) override {
    auto word = teacher_.find_counterexample(hypothesis, control);
    if (word) longest = std::max(longest, word->size());
    return word;
  }
  std::string guarantee() const override { return teacher_.guarantee(); }
  std::size_t longest = 1;

 private:
  EquivalenceOracle& teacher_;
};

std::uint64_t query_bound(std::string_view algorithm, std::uint64_t states, std::uint64_t inputs,
                          std::uint64_t longest) {
  const std::uint64_t rows = states * inputs + 1;
  if (algorithm == "lstar") {
    const std::uint64_t short_rows = states + (states - 1) * longest;
    return (short_rows * inputs + 1) * (inputs + states - 1) + states;
  }
  if (algorithm == "lmplus" || algorithm == "suffix1by1") {
    return rows * (inputs + (states - 1) * longest) + states;
  }
  if (algorithm == "rs") {
    const auto logarithm = static_cast<std::uint64_t>(std::bit_width(longest));
    return rows - 1 + rows * (states - 1) + (states - 1) * (1 + logarithm);
  }
  if (algorithm == "op" || algorithm == "ttt") {
    const auto logarithm = static_cast<std::uint64_t>(std::bit_width(longest));
    return states * states * inputs + states * inputs + (states - 1) * (3 + logarithm);
  }
  if (algorithm == "kv") {
    const auto logarithm = static_cast<std::uint64_t>(std::bit_width(longest));
    return states * states * inputs + states * inputs + (states - 1) * (states - 1) * logarithm +
           states;
  }
  if (algorithm == "tttlambda") {
    const auto logarithm = static_cast<std::uint64_t>(std::bit_width(longest));
    return states * states * inputs + states * inputs +
           (states - 1) * (3 + (states - 1) * logarithm);
  }
  if (algorithm == "adt") {  // twice that of "op": restructuring pays for itself
    const auto logarithm = static_cast<std::uint64_t>(std::bit_width(longest));
    return 2 * (states * states * inputs + states * inputs + (states - 1) * (3 + logarithm));
  }
  if (algorithm.starts_with("lsharp")) {
    const auto logarithm = static_cast<std::uint64_t>(std::bit_width(longest + states));
    return states * states * inputs + (states - 1) * (3 + logarithm);
  }
  ADD_FAILURE() << "no bound for " << algorithm;
  return 0;
}

struct Learned {
  Mealy model;
  std::uint64_t equivalence_queries = 0, output_queries = 0;
  std::size_t longest_counterexample = 0;
};

Learned learn_with(const LearnerEntry& algorithm, OutputOracle& oracle,
                   EquivalenceOracle& teacher) {
  MeasuringTeacher measured(teacher);
  const auto learner = algorithm.make(oracle);
  LearnResult result = run_learner(
      *learner, measured, {}, [&](const Mealy&, std::uint64_t) { learner->check_invariants(); });
  return {std::move(result.model), result.equivalence_queries, learner->output_queries(),
          measured.longest};
}

bool same_machine(const Mealy& left, const Mealy& right) {
  if (left.size() != right.size() || !(left.outputs() == right.outputs())) return false;
  for (StateId state = 0; state < left.size(); ++state) {
    for (Symbol input = 0; input < left.inputs().size(); ++input) {
      if (left.target(state, input) != right.target(state, input)) return false;
      if (left.output(state, input) != right.output(state, input)) return false;
    }
  }
  return true;
}

void expect_law(const LearnerEntry& algorithm, const Mealy& reference) {
  const Mealy minimal = minimize(reference);
  MealyOracle oracle(reference);
  PerfectOracle teacher(reference);
  const Learned run = learn_with(algorithm, oracle, teacher);
  ASSERT_FALSE(find_difference(reference, run.model).has_value());
  ASSERT_EQ(run.model.size(), minimal.size());
  ASSERT_TRUE(same_machine(run.model, breadth_first(run.model))) << "not in breadth-first order";
  ASSERT_LE(run.equivalence_queries, minimal.size());
  ASSERT_LE(run.output_queries, query_bound(algorithm.name, minimal.size(),
                                            reference.inputs().size(), run.longest_counterexample));
}

class LearnerLaws : public testing::TestWithParam<std::string> {
 protected:
  const LearnerEntry& algorithm() const { return find_deterministic_learner(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(All, LearnerLaws, testing::ValuesIn(test::learner_names()),
                         [](const auto& entry) { return test::as_test_name(entry.param); });

TEST_P(LearnerLaws, LearnsEverySmallMachine) {
  for (std::uint64_t states = 1; states <= 3; ++states) {
    for (std::uint64_t number = 0; number < count_small_machines(states); ++number) {
      expect_law(algorithm(), small_machine(states, number));
      if (HasFatalFailure()) FAIL() << "machine " << number << " of " << states << " states";
    }
  }
}

// So many machines, drawn from this seed.
struct RandomMachines {
  std::uint64_t seed;
  int count;
};

std::vector<RandomMachines> ten_thousand_machines() {
  std::vector<RandomMachines> batches;
  for (std::uint64_t seed = 2; seed <= 11; ++seed) batches.push_back({seed, 1000});
  return batches;
}

class RandomMachineLaws : public testing::TestWithParam<std::tuple<std::string, RandomMachines>> {};

std::string name_of(const testing::TestParamInfo<RandomMachineLaws::ParamType>& entry) {
  const auto& [algorithm, machines] = entry.param;
  return test::as_test_name(algorithm) + "_" + std::to_string(machines.seed);
}

INSTANTIATE_TEST_SUITE_P(All, RandomMachineLaws,
                         testing::Combine(testing::ValuesIn(test::learner_names()),
                                          testing::Values(RandomMachines{1, 150})),
                         name_of);
INSTANTIATE_TEST_SUITE_P(TenThousand, RandomMachineLaws,
                         testing::Combine(testing::ValuesIn(test::learner_names()),
                                          testing::ValuesIn(ten_thousand_machines())),
                         name_of);

TEST_P(RandomMachineLaws, LearnsEach) {
  const auto& [algorithm, machines] = GetParam();
  Random random(machines.seed);
  for (int i = 0; i < machines.count; ++i) {
    const RandomMealyOptions options{.states = random.between(1, 50),
                                     .inputs = random.between(1, 6),
                                     .outputs = random.between(1, 4)};
    expect_law(find_deterministic_learner(algorithm), random_mealy(options, random));
    if (HasFatalFailure()) FAIL() << "machine " << i << " of seed " << machines.seed;
  }
}

// More states than adaptive sequences are planned for at once.
TEST_P(LearnerLaws, LearnsAMachineOfManyStates) {
  Random random(6);
  expect_law(algorithm(), random_mealy({.states = 200, .inputs = 3, .outputs = 3}, random));
}

TEST_P(LearnerLaws, CachedAndUncachedRunsAreIdentical) {
  Random random(2);
  for (int i = 0; i < 30; ++i) {
    const Mealy reference = random_mealy({.states = 20, .inputs = 3, .outputs = 3}, random);
    MealyOracle plain(reference), below(reference);
    CountingOracle counter(below);
    Cache cache(counter);
    PerfectOracle first_teacher(reference), second_teacher(reference);
    const Learned uncached = learn_with(algorithm(), plain, first_teacher);
    const Learned cached = learn_with(algorithm(), cache, second_teacher);
    EXPECT_TRUE(same_machine(uncached.model, cached.model));
    EXPECT_EQ(uncached.output_queries, cached.output_queries);
    EXPECT_EQ(uncached.equivalence_queries, cached.equivalence_queries);
    // L# and ADT ask only what their own trees do not hold.
    const bool is_own_cache = algorithm().name.starts_with("lsharp") || algorithm().name == "adt";
    EXPECT_LT(counter.statistics().total().queries, cached.output_queries + (is_own_cache ? 1 : 0));
  }
}

TEST_P(LearnerLaws, EveryMethodFindsASmallMachineAndTheSameSeedIsTheSameRun) {
  Random random(3);
  for (const TestMethodEntry& method : test_methods()) {
    for (int i = 0; i < 10; ++i) {
      const Mealy reference = random_mealy({.states = 6, .inputs = 3, .outputs = 2}, random);
      std::uint64_t symbols[2] = {};
      for (std::uint64_t& sent : symbols) {
        MealyOracle oracle(reference);
        CountingOracle counter(oracle);
        Cache cache(counter);
        TestMethodOptions options;
        options.seed = 5;
        const auto teacher = TestChain(method.name).make({cache, &cache, &reference}, options);
        const Learned run = learn_with(algorithm(), cache, *teacher);
        EXPECT_FALSE(find_difference(reference, run.model).has_value()) << method.name;
        EXPECT_NE(teacher->guarantee(), "");
        sent = counter.statistics().total().symbols;
      }
      EXPECT_EQ(symbols[0], symbols[1]) << method.name;
    }
  }
}

TEST_P(LearnerLaws, RefusesAWordThatIsNoCounterexample) {
  const Mealy reference = small_machine(3, 12345);
  MealyOracle oracle(reference);
  PerfectOracle teacher(reference);
  const auto learner = algorithm().make(oracle);
  run_learner(*learner, teacher);
  EXPECT_THROW(learner->refine({0, 1, 0, 1}), std::invalid_argument);
}

TEST_P(LearnerLaws, LongCounterexamplesAreHandledUntilTheHypothesisAgrees) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Mealy reference = random_mealy({.states = 30, .inputs = 2, .outputs = 2}, random);
    MealyOracle oracle(reference);
    const auto learner = algorithm().make(oracle);
    learner->start();
    Word word(500);
    for (int round = 0; round < 5; ++round) {
      for (Symbol& input : word) input = static_cast<Symbol>(random.below(2));
      if (learner->hypothesis().output_word(word) == reference.output_word(word)) continue;
      learner->refine(word);
      learner->check_invariants();
      EXPECT_EQ(learner->hypothesis().output_word(word), reference.output_word(word));
    }
  }
}

// Stops the run after a number of output queries.
class StoppingOracle : public MealyOracle {
 public:
  StoppingOracle(const Mealy& machine, std::uint64_t queries)
      : MealyOracle(machine), left_(queries) {}
  using MealyOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    if (batch.size() > left_) throw Interrupted("stopped");
    left_ -= batch.size();
    return MealyOracle::ask(batch, control, sink);
  }
  void allow() { left_ = ~std::uint64_t{0}; }

 private:
  std::uint64_t left_;
};

TEST_P(LearnerLaws, AnInterruptedLearnerKeepsItsHypothesisAndCanGoOn) {
  Random random(5);
  const Mealy reference = random_mealy({.states = 25, .inputs = 3, .outputs = 2}, random);
  PerfectOracle teacher(reference);
  int interrupted = 0;
  for (std::uint64_t queries = 20; queries < 4000; queries += 50) {
    StoppingOracle oracle(reference, queries);
    const auto learner = algorithm().make(oracle);
    try {
      run_learner(*learner, teacher);
    } catch (const Interrupted&) {
      ++interrupted;
      oracle.allow();
      if (learner->hypothesis().size() == 0) learner->start();
      EXPECT_TRUE(learner->hypothesis().is_complete());
      while (const auto word = teacher.find_counterexample(learner->hypothesis())) {
        learner->refine(*word);
      }
    }
    EXPECT_FALSE(find_difference(reference, learner->hypothesis()).has_value());
  }
  EXPECT_GT(interrupted, 3);
}

}  // namespace
}  // namespace maide
