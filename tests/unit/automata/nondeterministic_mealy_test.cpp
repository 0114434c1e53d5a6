// Observable nondeterministic machines: what they refuse, minimal forms, shortest differences.
#include "maide/automata/nondeterministic_mealy.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

// A coin is tossed by "toss"; "look" tells how it lies; at first it lies "heads".
NondeterministicMealy coin() {
  NondeterministicMealy machine({"toss", "look"}, {"done", "heads", "tails"}, 3);
  machine.add_choice(0, 0, 0, 2);
  machine.add_choice(0, 1, 1, 0);
  machine.add_choice(1, 0, 0, 2);
  machine.add_choice(1, 1, 2, 1);
  machine.add_choice(2, 0, 0, 2);
  machine.add_choice(2, 1, 1, 0);
  machine.add_choice(2, 1, 2, 1);
  return machine;
}

TEST(NondeterministicMealy, KeepsChoicesInOrderAndRefusesWhatIsNotObservable) {
  NondeterministicMealy machine({"a"}, {"x", "y"}, 2);
  EXPECT_FALSE(machine.is_complete());
  machine.add_choice(0, 0, 1, 0);
  machine.add_choice(0, 0, 0, 1);
  machine.add_choice(0, 0, 1, 0);
  machine.add_choice(1, 0, 0, 0);
  EXPECT_TRUE(machine.is_complete());
  EXPECT_FALSE(machine.is_deterministic());
  EXPECT_EQ(machine.transition_count(), 3U);
  EXPECT_EQ(machine.choices(0, 0)[0].output, 0U);
  EXPECT_EQ(machine.successor(0, 0, 1), 0U);
  EXPECT_EQ(machine.successor(1, 0, 1), Mealy::no_state);
  EXPECT_THROW(machine.add_choice(0, 0, 0, 0), UsageError);
  EXPECT_FALSE(machine.to_mealy().has_value());
}

TEST(NondeterministicMealy, DeterministicMachinesComeBackAsTheyWere) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Mealy machine = random_mealy({.states = 8, .inputs = 2, .outputs = 2}, random);
    const NondeterministicMealy wide(machine);
    ASSERT_TRUE(wide.to_mealy().has_value());
    EXPECT_EQ(minimize(wide).size(), minimize(machine).size());
    std::ostringstream left, right;
    write_dot(left, machine);
    write_dot(right, *wide.to_mealy());
    EXPECT_EQ(left.str(), right.str());
  }
}

TEST(NondeterministicMealy, MinimalMachinesHaveTheSameTraces) {
  EXPECT_EQ(minimize(coin()).size(), 3U);
  NondeterministicMealy doubled({"toss", "look"}, {"tails", "done", "heads"}, 6);
  for (StateId copy = 0; copy < 6; copy += 3) {
    const StateId other = 3 - copy;  // the two copies lead to each other
    doubled.add_choice(copy, 0, 1, other + 2);
    doubled.add_choice(copy, 1, 2, other);
    doubled.add_choice(copy + 1, 0, 1, other + 2);
    doubled.add_choice(copy + 1, 1, 0, other + 1);
    doubled.add_choice(copy + 2, 0, 1, other + 2);
    doubled.add_choice(copy + 2, 1, 2, other);
    doubled.add_choice(copy + 2, 1, 0, other + 1);
  }
  EXPECT_FALSE(find_difference(doubled, coin()).has_value());
  const NondeterministicMealy minimal = minimize(doubled);
  EXPECT_EQ(minimal.size(), 3U);
  EXPECT_FALSE(find_difference(minimal, coin()).has_value());
}

TEST(NondeterministicMealy, ADifferenceIsAShortestTraceAndAnInput) {
  NondeterministicMealy loaded = coin();
  NondeterministicMealy other({"toss", "look"}, {"done", "heads", "tails"}, 2);
  other.add_choice(0, 0, 0, 1);
  other.add_choice(0, 1, 1, 0);
  other.add_choice(1, 0, 0, 1);
  other.add_choice(1, 1, 1, 0);  // never tails
  const auto difference = find_difference(loaded, other);
  ASSERT_TRUE(difference.has_value());
  ASSERT_EQ(difference->trace.size(), 1U);
  EXPECT_EQ(difference->trace[0], (std::pair<std::string, std::string>("toss", "done")));
  EXPECT_EQ(difference->input, "look");
  EXPECT_EQ(difference->left, (std::vector<std::string>{"heads", "tails"}));
  EXPECT_EQ(difference->right, (std::vector<std::string>{"heads"}));

  const auto missing = find_difference(coin(), NondeterministicMealy({"toss"}, {"done"}, 1));
  ASSERT_TRUE(missing.has_value());
  EXPECT_TRUE(missing->trace.empty());
}

TEST(NondeterministicMealy, IsWrittenAndReadAsItWas) {
  std::ostringstream out;
  write_dot(out, coin());
  const Model model = read_dot(out.str(), "coin.dot");
  ASSERT_TRUE(std::holds_alternative<NondeterministicMealy>(model));
  const auto& back = std::get<NondeterministicMealy>(model);
  EXPECT_EQ(back.size(), 3U);
  EXPECT_FALSE(find_difference(back, coin()).has_value());
  std::ostringstream again;
  write_dot(again, back);
  EXPECT_EQ(again.str(), out.str());
}

}  // namespace
}  // namespace maide
