// A newcomer's machine under the whole stack, and the counts of what reached it.
#include "maide/learn/oracle/sul_oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/table/table_learners.hpp"

namespace maide {
namespace {

class CoffeeMachine {
 public:
  Alphabet inputs() const { return {"coin", "button"}; }
  void reset() {
    coins_ = 0;
    ++resets;
  }
  std::string step(const std::string& input) {
    ++steps;
    if (input == "coin") {
      coins_ = std::min(coins_ + 1, 2);
      return "quiet";
    }
    const bool enough = coins_ == 2;
    if (enough) coins_ = 0;
    return enough ? "coffee" : "beep";
  }
  std::uint64_t resets = 0, steps = 0;

 private:
  int coins_ = 0;
};

TEST(SulOracle, LearnsAnyClassThatCanBeResetAndStepped) {
  CoffeeMachine machine;
  SulOracle system{machine};
  Cache oracle{system};
  RivestSchapire learner{oracle};
  WMethod teacher{oracle, {.extra_states = 2}};

  const Mealy model = learn(learner, teacher);

  EXPECT_EQ(model.size(), 3U);
  EXPECT_EQ(to_string(model.output_word(Word{0, 1, 0, 1}), model.outputs()),
            "quiet beep quiet coffee");
}

TEST(SulOracle, CountsAreWhatTheMachineSaw) {
  CoffeeMachine machine;
  SulOracle system{machine};
  CountingOracle counter{system};
  Cache oracle{counter};
  WMethod tests{oracle};
  PhasedTeacher teacher{tests, counter};
  RivestSchapire learner{oracle};
  run_learner(learner, teacher);
  const Statistics& statistics = counter.statistics();
  EXPECT_EQ(statistics.total().resets, machine.resets);
  EXPECT_EQ(statistics.total().symbols, machine.steps);
  EXPECT_EQ(statistics.total().queries, machine.resets);
  EXPECT_GT(statistics.at(LearnPhase::learning).queries, 0U);
  EXPECT_GT(statistics.at(LearnPhase::testing).queries, 0U);
  EXPECT_EQ(oracle.misses(), machine.resets);
}

TEST(SulOracle, FollowsADecisionTree) {
  CoffeeMachine machine;
  SulOracle system{machine};
  const Symbol beep = system.intern_output("beep"), coffee = system.intern_output("coffee");
  DecisionTree tree;
  tree.nodes = {{1, {{coffee, 1}, {beep, 2}}}, {1, {}}, {0, {}}};
  const Query query = tree;
  const MealyAnswer answer = system.ask(std::span(&query, 1)).front();
  EXPECT_EQ(answer.inputs, (Word{1, 0}));
  EXPECT_EQ(to_string(answer.outputs, system.outputs()), "beep quiet");
}

class BreakingMachine : public CoffeeMachine {
 public:
  void reset() {
    if (resets == 3) throw std::runtime_error("out of beans");
    CoffeeMachine::reset();
  }
};

TEST(SulOracle, WhatTheMachineThrowsPassesAndEarlierAnswersAreHandedOver) {
  BreakingMachine machine;
  SulOracle system{machine};
  const std::vector<Query> batch(5, Word{0});
  std::size_t answered = 0;
  EXPECT_THROW(
      system.ask(batch, {},
                 [&](std::size_t index, const MealyAnswer&) { EXPECT_EQ(index, answered++); }),
      std::runtime_error);
  EXPECT_EQ(answered, 3U);
}

TEST(SulOracle, StopsWhenAsked) {
  CoffeeMachine machine;
  SulOracle system{machine};
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  EXPECT_THROW(system.ask(Word{0}, control), Interrupted);
  EXPECT_EQ(machine.resets, 0U);
}

TEST(Learners, UnknownNamesListTheKnownOnes) {
  std::vector<std::string> known;
  for (const LearnerEntry& entry : deterministic_learners()) known.emplace_back(entry.name);
  try {
    find_deterministic_learner("magic");
    FAIL() << "found";
  } catch (const UsageError& error) {
    EXPECT_EQ(error.what(), "unknown algorithm 'magic'; known are: " + join(known));
  }
}

}  // namespace
}  // namespace maide
