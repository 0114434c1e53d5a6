// What tells the learners with a discrimination tree from each other: what stays of a
// counterexample.
#include <gtest/gtest.h>

#include <algorithm>

#include "maide/automata/compare.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/learner.hpp"
#include "oracles.hpp"

namespace maide {
namespace {

struct Costs {
  std::size_t symbols = 0;
  std::size_t median = 0;  // length of a word; the largest of all machines
};

// What it costs to learn ten machines from random counterexamples of this length.
Costs learn_from_long_counterexamples(std::string_view algorithm, std::size_t length) {
  Random random(6);
  Costs costs;
  for (int i = 0; i < 10; ++i) {
    // What differs shows in one place alone, so counterexamples stay long when they are cut.
    Mealy machine = random_mealy({.states = 40, .inputs = 3, .outputs = 1}, random);
    machine.set_transition(39, 0, machine.intern_output("o1"), machine.target(39, 0));
    RecordingOracle oracle(machine);
    const auto learner = find_deterministic_learner(algorithm).make(oracle);
    learner->start();
    for (int round = 0; round < 300; ++round) {
      Word word(length);
      for (Symbol& input : word) input = static_cast<Symbol>(random.below(3));
      if (learner->hypothesis().output_word(word) == machine.output_word(word)) continue;
      learner->refine(word);
    }
    EXPECT_FALSE(find_difference(learner->hypothesis(), machine));
    std::vector<std::size_t> lengths;
    for (const Query& query : oracle.asked) lengths.push_back(std::get<Word>(query).size());
    std::sort(lengths.begin(), lengths.end());
    for (const std::size_t one : lengths) costs.symbols += one;
    costs.median = std::max(costs.median, lengths[lengths.size() / 2]);
  }
  return costs;
}

TEST(TreeLearners, NothingOfLongCounterexamplesIsKept) {
  const Costs pack = learn_from_long_counterexamples("op", 1000);
  for (const std::string_view algorithm : {"ttt", "tttlambda"}) {
    const Costs costs = learn_from_long_counterexamples(algorithm, 1000);
    EXPECT_LT(2 * costs.median, pack.median) << algorithm;
    EXPECT_LT(costs.symbols, pack.symbols) << algorithm;
  }
}

TEST(TreeLearners, AStateKeepsItsNumberFromOneHypothesisToTheNext) {
  Random random(7);
  for (const std::string_view algorithm : {"op", "kv", "ttt", "tttlambda", "adt"}) {
    const Mealy machine = random_mealy({.states = 60, .inputs = 2, .outputs = 2}, random);
    MealyOracle oracle(machine);
    const auto learner = find_deterministic_learner(algorithm).make(oracle);
    learner->start();
    int rounds = 0;
    while (const auto word = find_distinguishing_word(learner->hypothesis(), machine)) {
      const Mealy before = learner->hypothesis();
      learner->refine(*word);
      const Mealy& after = learner->hypothesis();
      ASSERT_GT(after.size(), before.size());
      for (StateId state = 0; state < before.size(); ++state) {
        for (Symbol input = 0; input < 2; ++input) {
          ASSERT_EQ(before.output(state, input), after.output(state, input));
        }
      }
      ++rounds;
    }
    EXPECT_GT(rounds, 3);
  }
}

// States are told apart without a reset between most of the words that do so.
TEST(TreeLearners, AdtSparesResets) {
  Random random(8);
  const Mealy machine = random_mealy({.states = 200, .inputs = 5, .outputs = 3}, random);
  std::size_t resets[2] = {};
  for (const bool is_adaptive : {false, true}) {
    RecordingOracle oracle(machine);
    const auto learner = find_deterministic_learner(is_adaptive ? "adt" : "op").make(oracle);
    learner->start();
    while (const auto word = find_distinguishing_word(learner->hypothesis(), machine)) {
      learner->refine(*word);
    }
    resets[is_adaptive ? 1 : 0] = oracle.asked.size();
  }
  EXPECT_LT(3 * resets[1], 2 * resets[0]);
}

// Answers 1 to the second input of the first long word, and 0 to everything else.
TEST(TreeLearners, ASystemThatContradictsItselfIsReportedAsSuch) {
  for (const std::string_view algorithm : {"op", "kv", "ttt", "tttlambda"}) {
    ScriptedOracle oracle({"a"}, {"0", "1"});
    bool is_first = true;
    oracle.script = [&](std::span<const Query> batch, const OutputOracle::PartialSink&) {
      std::vector<MealyAnswer> answers(batch.size());
      for (std::size_t i = 0; i < batch.size(); ++i) {
        answers[i].inputs = std::get<Word>(batch[i]);
        answers[i].outputs.assign(answers[i].inputs.size(), 0);
        if (answers[i].outputs.size() > 1 && is_first) answers[i].outputs[1] = 1;
        is_first = is_first && answers[i].outputs.size() < 2;
      }
      return answers;
    };
    const auto learner = find_deterministic_learner(algorithm).make(oracle);
    learner->start();
    try {
      learner->refine({0, 0});
      ADD_FAILURE() << algorithm;
    } catch (const NondeterminismError& error) {  // an output, a digit, for each input, a letter
      EXPECT_NE(error.first_answer(), error.second_answer()) << algorithm;
      EXPECT_EQ(error.first_answer().size(), error.word().size()) << algorithm;
      EXPECT_EQ(error.second_answer().size(), error.word().size()) << algorithm;
    }
    EXPECT_TRUE(learner->hypothesis().is_complete());
  }
}

}  // namespace
}  // namespace maide
