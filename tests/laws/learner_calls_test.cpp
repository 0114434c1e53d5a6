// Random sequences of calls on every learner: counterexamples of all lengths, interruptions, and
// words that are none. After each its invariants hold, and it keeps what the interface promises.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "learner_names.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "random_calls.hpp"

namespace maide::test {
namespace {

TEST(Shrinking, LeavesOnlyTheCallsThatMatter) {
  // Fails if a call of kind 3 comes after one of kind 1 with a value of at least 5.
  const auto play = [](const Scenario& scenario) -> std::string {
    bool is_armed = false;
    for (const Call& call : scenario.calls) {
      if (call.kind == 1 && call.value >= 5) is_armed = true;
      if (call.kind == 3 && is_armed) return "it fails";
    }
    return "";
  };
  Random random(1);
  Scenario scenario{42, {}};
  for (int i = 0; i < 100; ++i) {
    scenario.calls.push_back({static_cast<std::uint32_t>(random.below(5)),
                              static_cast<std::uint32_t>(random.below(100))});
  }
  ASSERT_NE(play(scenario), "");
  const Scenario small = shrink(scenario, play);
  EXPECT_EQ(to_text(small), "{42, {{1, 7}, {3, 0}}}");
}

// Stops the run after a number of queries.
class StoppingOracle : public MealyOracle {
 public:
  using MealyOracle::ask;
  using MealyOracle::MealyOracle;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    if (batch.size() > left) throw Interrupted("stopped");
    left -= batch.size();
    return MealyOracle::ask(batch, control, sink);
  }
  std::uint64_t left = ~std::uint64_t{0};
};

class LearnerWorld {
 public:
  enum Kind : std::uint32_t { refine, refine_by_long_word, refine_by_shortest, interrupt, refuse };
  static constexpr std::uint32_t kinds = 5;

  LearnerWorld(const LearnerEntry& algorithm, std::uint64_t seed)
      : machine_(random_machine(seed, 25)),
        minimal_size_(minimize(machine_).size()),
        oracle_(machine_),
        teacher_(machine_),
        learner_(algorithm.make(oracle_)) {
    learner_->start();
    expect_laws();
  }

  void call(const Call& call) {
    Random random(call.value);
    const std::size_t inputs = machine_.inputs().size();
    switch (call.kind) {
      case refine: refine_with(random_word(random, inputs, 12)); break;
      case refine_by_long_word: refine_with(random_word(random, inputs, 120)); break;
      case refine_by_shortest:
        if (const auto word = teacher_.find_counterexample(learner_->hypothesis())) {
          refine_with(*word);
        }
        break;
      case interrupt: refine_and_stop(random_word(random, inputs, 60), call.value % 40); break;
      default: refuse_word(random_word(random, inputs, 12)); break;
    }
  }

  void finish() {
    std::size_t rounds = 0;
    while (const auto word = teacher_.find_counterexample(learner_->hypothesis())) {
      refine_with(*word);
      promise(++rounds <= minimal_size_, "every counterexample adds a state");
    }
    promise(!find_difference(machine_, learner_->hypothesis()), "it learns the machine");
    promise(learner_->hypothesis().size() == minimal_size_, "it learns the minimal machine");
  }

 private:
  bool is_right(const Word& word) const {
    return learner_->hypothesis().output_word(word) == machine_.output_word(word);
  }

  void refine_with(const Word& word) {
    if (is_right(word)) return;
    learner_->refine(word);
    promise(is_right(word), "a refined hypothesis agrees on the counterexample");
    expect_laws();
  }

  // In the middle of the work; then again, to the end.
  void refine_and_stop(const Word& word, std::uint64_t queries) {
    if (is_right(word)) return;
    oracle_.left = queries;
    try {
      learner_->refine(word);
    } catch (const Interrupted&) {
      promise(learner_->hypothesis().is_complete(), "a stopped learner has a whole hypothesis");
    }
    oracle_.left = ~std::uint64_t{0};
    if (is_right(word)) return;
    learner_->refine(word);
    promise(is_right(word), "a learner that was stopped goes on");
    expect_laws();
  }

  void refuse_word(const Word& word) {
    if (!is_right(word)) return;
    try {
      learner_->refine(word);
    } catch (const std::invalid_argument&) {
      return expect_laws();
    }
    promise(false, "a word that is no counterexample is refused");
  }

  void expect_laws() {
    learner_->check_invariants();
    const Mealy& hypothesis = learner_->hypothesis();
    promise(hypothesis.is_complete(), "the hypothesis is complete");
    promise(hypothesis.size() <= minimal_size_, "it has no more states than the machine");
    promise(hypothesis.size() >= states_, "it loses no state");
    promise(learner_->output_queries() >= queries_, "queries are counted");
    promise(breadth_first(hypothesis).size() == hypothesis.size(), "all states are reached");
    states_ = hypothesis.size();
    queries_ = learner_->output_queries();
  }

  Mealy machine_;
  std::size_t minimal_size_;
  StoppingOracle oracle_;
  PerfectOracle teacher_;
  std::unique_ptr<Learner> learner_;
  std::size_t states_ = 0;
  std::uint64_t queries_ = 0;
};

std::string play_learner(const LearnerEntry& algorithm, const Scenario& scenario) {
  return play_calls(scenario, [&](std::uint64_t seed) {
    return std::make_unique<LearnerWorld>(algorithm, seed);
  });
}

class LearnerCalls : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, LearnerCalls, testing::ValuesIn(learner_names()),
                         [](const auto& entry) { return as_test_name(entry.param); });

TEST_P(LearnerCalls, KeepItsPromises) {
  const LearnerEntry& algorithm = find_learner(GetParam());
  const auto play = [&](const Scenario& scenario) { return play_learner(algorithm, scenario); };
  expect_no_failure(
      RandomCalls{.scenarios = 60, .calls = 12, .kinds = LearnerWorld::kinds, .values = 1000},
      play);
}

// Sequences that failed once, and one for each way to go on after an interruption; by learner.
TEST(LearnerCallRegressions, StayMended) {
  const std::vector<std::pair<std::string, Scenario>> scenarios{
      {"lsharp", {3, {{3, 25}, {2, 0}, {3, 1}, {1, 8}}}},
      {"ttt", {5, {{1, 12}, {3, 4}, {3, 31}, {0, 77}}}},
      {"tttlambda", {11, {{3, 0}, {1, 3}, {4, 9}, {3, 17}}}},
      {"adt", {8, {{1, 40}, {3, 12}, {2, 0}, {3, 38}}}},
  };
  for (const auto& [name, scenario] : scenarios) {
    EXPECT_EQ(play_learner(find_deterministic_learner(name), scenario), "") << name;
  }
}

}  // namespace
}  // namespace maide::test
