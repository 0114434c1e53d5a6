// The perfect oracle: a hypothesis and the next one compared.
#include <gtest/gtest.h>

#include "maide/automata/compare.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide {
namespace {

// Machines that change anyhow: transitions, outputs, new states, all of it at once. The word is
// that of Hopcroft & Karp's comparison, each time.
TEST(IncrementalComparison, GivesTheWordOfTheComparisonOfWholeMachines) {
  Random random(1);
  int equivalent = 0, long_words = 0;
  for (int machine = 0; machine < 300; ++machine) {
    const std::size_t inputs = random.between(1, 4), outputs = random.between(1, 3);
    const Mealy reference = random_mealy(
        {.states = random.between(1, 12), .inputs = inputs, .outputs = outputs}, random);
    Mealy hypothesis = reference, earlier = reference;
    IncrementalComparison comparison(reference);
    for (int step = 0; step < 40; ++step) {
      const auto expected = find_distinguishing_word(hypothesis, reference);
      ASSERT_EQ(comparison.find_difference(hypothesis), expected) << machine << " " << step;
      equivalent += expected ? 0 : 1;
      long_words += expected && expected->size() > 4 ? 1 : 0;
      if (random.chance(0.2)) {  // a twin of some state
        const auto twin = static_cast<StateId>(random.below(hypothesis.size()));
        const StateId added = hypothesis.add_state();
        for (Symbol input = 0; input < inputs; ++input) {
          hypothesis.set_transition(added, input, hypothesis.output(twin, input),
                                    hypothesis.target(twin, input));
        }
      }
      for (std::size_t changes = random.below(4); changes > 0; --changes) {
        const auto state = static_cast<StateId>(random.below(hypothesis.size()));
        const auto input = static_cast<Symbol>(random.below(inputs));
        const auto target = static_cast<StateId>(random.below(hypothesis.size()));
        const Symbol output = random.chance(0.2) ? static_cast<Symbol>(random.below(outputs))
                                                 : hypothesis.output(state, input);
        hypothesis.set_transition(state, input, output, target);
      }
      if (random.chance(0.3)) hypothesis = reference;
      if (random.chance(0.1)) std::swap(hypothesis, earlier);
      if (random.chance(0.1)) {
        hypothesis.set_initial(static_cast<StateId>(random.below(hypothesis.size())));
      }
    }
  }
  EXPECT_GT(equivalent, 300);
  EXPECT_GT(long_words, 100);
}

// Hypotheses as learners make them, those that keep their states' numbers and those that do not.
TEST(IncrementalComparison, FollowsEveryLearner) {
  Random random(2);
  for (int machine = 0; machine < 10; ++machine) {
    Mealy reference = random_mealy({.states = 80, .inputs = 3, .outputs = 1}, random);
    for (int i = 0; i < 8; ++i) {
      reference.set_transition(static_cast<StateId>(random.below(80)), 0,
                               reference.intern_output("o1"), 0);
    }
    for (const LearnerEntry& entry : deterministic_learners()) {
      MealyOracle oracle(reference);
      IncrementalComparison comparison(reference);
      const auto learner = entry.make(oracle);
      learner->start();
      while (true) {
        const auto word = comparison.find_difference(learner->hypothesis());
        ASSERT_EQ(word, find_distinguishing_word(learner->hypothesis(), reference)) << entry.name;
        if (!word) break;
        learner->refine(*word);
      }
    }
  }
}

// As those of another learner are, which saw outputs in another order.
TEST(IncrementalComparison, OutputsMayBeNumberedOtherwise) {
  Mealy reference({"a"}, {"x", "y"}, 2);
  reference.set_transition(0, 0, 0, 1);
  reference.set_transition(1, 0, 1, 0);
  Mealy same({"a"}, {"y", "x"}, 2);
  same.set_transition(0, 0, 1, 1);
  same.set_transition(1, 0, 0, 0);
  IncrementalComparison comparison(reference);
  EXPECT_EQ(comparison.find_difference(reference), std::nullopt);
  EXPECT_EQ(comparison.find_difference(same), std::nullopt);
  EXPECT_EQ(comparison.find_difference(reference), std::nullopt);
}

TEST(IncrementalComparison, MatchesInputsAndOutputsByName) {
  Mealy reference({"a", "b"}, {"0", "1"}, 1);
  reference.set_transition(0, 0, 0, 0);
  reference.set_transition(0, 1, 1, 0);
  Mealy hypothesis({"b", "a"}, {"1", "0"}, 1);
  hypothesis.set_transition(0, 0, 0, 0);
  hypothesis.set_transition(0, 1, 1, 0);
  IncrementalComparison comparison(reference);
  EXPECT_EQ(comparison.find_difference(hypothesis), std::nullopt);
  hypothesis.set_transition(0, 0, hypothesis.intern_output("2"), 0);
  EXPECT_EQ(comparison.find_difference(hypothesis), Word{0});
  Mealy other({"a", "c"}, {"0"}, 1);
  EXPECT_THROW(comparison.find_difference(other), UsageError);
}

}  // namespace
}  // namespace maide
