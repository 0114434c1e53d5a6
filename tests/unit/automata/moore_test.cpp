// Moore machines as Mealy machines.
#include <gtest/gtest.h>

#include "maide/automata/compare.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"

namespace maide {
namespace {

// Accepts words that end in a: two states, but one as a Mealy machine.
Mealy ends_in_a() {
  Mealy machine({"a", "b"}, {accepting_output, rejecting_output}, 2);
  for (const StateId state : {0, 1}) {
    machine.set_transition(state, 0, 0, 1);
    machine.set_transition(state, 1, 1, 0);
  }
  mark_as_moore(machine, "dfa", rejecting_output);
  return machine;
}

TEST(Moore, StatesHaveTheOutputOfTheTransitionsThatLeadThere) {
  const std::vector<std::string> expected{rejecting_output, accepting_output};
  EXPECT_EQ(find_state_outputs(ends_in_a()), expected);
  Mealy plain = ends_in_a();
  plain.origin.clear();
  EXPECT_FALSE(find_state_outputs(plain).has_value());
  Mealy other = ends_in_a();
  mark_as_moore(other, "dfa", accepting_output);  // but b leads to the initial state
  EXPECT_FALSE(find_state_outputs(other).has_value());
}

TEST(Moore, SplittingIsTheInverseOfMinimisation) {
  const Mealy minimal = minimize(ends_in_a());
  EXPECT_EQ(minimal.size(), 1U);
  EXPECT_FALSE(find_state_outputs(minimal).has_value());
  const Mealy split = split_states(minimal);
  EXPECT_EQ(split.size(), 2U);
  EXPECT_EQ(find_state_outputs(split), find_state_outputs(ends_in_a()));
}

TEST(Moore, SplittingKeepsEveryWord) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    Mealy machine = random_mealy({.states = 12, .inputs = 3, .outputs = 2}, random);
    mark_as_moore(machine, "moore", "o0");
    const Mealy split = split_states(machine);
    EXPECT_FALSE(find_difference(machine, split).has_value());
    ASSERT_TRUE(find_state_outputs(split).has_value());
    // Minimal: as many as pairs of a state of the minimal machine and an output.
    EXPECT_EQ(split_states(minimize(split)).size(), split_states(minimize(machine)).size());
    EXPECT_LE(split_states(minimize(machine)).size(), split.size());
  }
}

}  // namespace
}  // namespace maide
