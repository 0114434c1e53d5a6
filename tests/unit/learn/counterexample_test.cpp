#include "maide/learn/counterexample.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

// Answers "0" except to every `states`-th input, whichever it is.
Mealy counter_machine(std::size_t states) {
  Mealy machine({"a", "b"}, {"0", "1"}, states);
  for (StateId state = 0; state < states; ++state) {
    for (Symbol input = 0; input < 2; ++input) {
      machine.set_transition(state, input, state + 1 == states ? 1 : 0,
                             static_cast<StateId>((state + 1) % states));
    }
  }
  return machine;
}

TEST(FirstMismatch, CutsWhereTheOutputsDiffer) {
  const Mealy machine = counter_machine(3);
  const Word word{0, 1, 0, 0};
  EXPECT_EQ(first_mismatch(machine, word, {0, 0, 1, 0}), 0U);
  EXPECT_EQ(first_mismatch(machine, word, {0, 0, 0, 0}), 3U);
  EXPECT_EQ(first_mismatch(machine, word, {1, 0, 0, 0}), 1U);
}

// The decomposition's claim, checked on the machine itself.
TEST(Decompose, TellsApartWhatTheHypothesisTakesForOne) {
  for (std::size_t states = 2; states < 40; ++states) {
    const Mealy machine = counter_machine(states);
    Mealy wrong({"a", "b"}, {"0", "1"}, 1);
    wrong.set_transition(0, 0, 0, 0);
    wrong.set_transition(0, 1, 0, 0);
    const Word counterexample(states, 1);
    MealyOracle oracle(machine);
    CountingOracle counter(oracle);
    const std::vector<Word> access{{}};
    const Decomposition split = decompose(wrong, access, counterexample, 1, counter, {});
    EXPECT_LE(split.output_queries, static_cast<std::uint64_t>(std::bit_width(states - 1)));
    EXPECT_EQ(split.output_queries, counter.statistics().total().queries);
    ASSERT_LT(split.position + 1, states);
    const Word suffix(counterexample.begin() + static_cast<std::ptrdiff_t>(split.position) + 1,
                      counterexample.end());
    Word one_step{1};
    one_step.insert(one_step.end(), suffix.begin(), suffix.end());
    EXPECT_NE(machine.output_word(one_step).back(), machine.output_word(suffix).back());
  }
}

}  // namespace
}  // namespace maide
