// All independent differences of two models: words that a plain walk confirms, one difference a
// change, and none for models that are the same.
#include "maide/automata/differences.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

struct Found {
  BehaviourPair pair;
  Differences differences;
  std::string question(std::size_t place) const {
    return pair.questions[differences.list[place].question];
  }
};

Found find(const Mealy& left, const Mealy& right) {
  Found found;
  found.pair = read_behaviours(NondeterministicMealy(left), NondeterministicMealy(right));
  found.differences = find_differences(found.pair);
  return found;
}

Found find(const std::string& left, const std::string& right) {
  const auto read = [](const std::string& name) {
    return read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot");
  };
  Found found;
  found.pair = read_behaviours(read(left), read(right));
  found.differences = find_differences(found.pair);
  return found;
}

// The inputs of the way and of the question, of a difference of Mealy machines.
std::vector<std::string> word_of(const Found& found, const Difference& difference) {
  std::vector<std::string> word;
  for (const JointStep& step : difference.way) {
    word.push_back(step.left.substr(0, step.left.find(" / ")));
  }
  word.push_back(found.pair.questions[difference.question]);
  return word;
}

std::vector<std::string> play(const Mealy& machine, const std::vector<std::string>& word) {
  std::vector<std::string> outputs;
  StateId state = machine.initial();
  for (const std::string& name : word) {
    const Symbol input = machine.inputs().at(name);
    outputs.push_back(machine.outputs().name(machine.output(state, input)));
    state = machine.target(state, input);
  }
  return outputs;
}

// A ring: `a` goes on, `b` tells where it is.
Mealy ring(std::size_t states) {
  Mealy machine({"a", "b"}, {"ok"}, states);
  for (StateId state = 0; state < states; ++state) {
    machine.set_transition(state, 0, 0, static_cast<StateId>((state + 1) % states));
    machine.set_transition(state, 1, machine.intern_output("at " + std::to_string(state)), state);
  }
  return machine;
}

TEST(Differences, EachChangedOutputIsOne) {
  const Mealy left = ring(6);
  Mealy right = left;
  right.set_transition(2, 1, right.intern_output("lost"), 2);
  right.set_transition(4, 1, right.intern_output("lost"), 4);
  const Found found = find(left, right);
  ASSERT_THAT(found.differences.list, SizeIs(2));
  EXPECT_THAT(word_of(found, found.differences.list[0]), ElementsAre("a", "a", "b"));
  EXPECT_THAT(word_of(found, found.differences.list[1]), ElementsAre("a", "a", "a", "a", "b"));
  EXPECT_EQ(found.differences.list[0].left, "at 2");
  EXPECT_EQ(found.differences.list[0].right, "lost");
  EXPECT_EQ(found.differences.count_bounds(), 0U);
}

// A wrong target makes a word differ behind it; all words behind it follow from it.
TEST(Differences, AChangedTargetIsOne) {
  const Mealy left = ring(6);
  Mealy right = left;
  right.set_transition(2, 0, 0, 5);
  const Found found = find(left, right);
  ASSERT_THAT(found.differences.list, SizeIs(1));
  EXPECT_THAT(word_of(found, found.differences.list[0]), ElementsAre("a", "a", "a", "b"));
  // All states that both have are partners all the same; right has 4 states that a word leads to.
  EXPECT_THAT(found.differences.right_partners, testing::Each(testing::Ne(Mealy::no_state)));
}

// The first answer of all differs, and another one far behind it.
TEST(Differences, TheSearchGoesOnBehindADifference) {
  Mealy left = ring(4);
  left.set_transition(0, 0, left.intern_output("hello"), 1);
  Mealy right = ring(4);
  right.set_transition(0, 0, right.intern_output("welcome"), 1);
  right.set_transition(3, 1, right.intern_output("lost"), 3);
  const Found found = find(left, right);
  ASSERT_THAT(found.differences.list, SizeIs(2));
  EXPECT_EQ(found.differences.list[0].passed(), 0U);
  EXPECT_EQ(found.differences.list[1].passed(), 1U);
  EXPECT_THAT(word_of(found, found.differences.list[1]), ElementsAre("a", "a", "a", "b"));
}

// A queue of many states that look alike for long: two changes far from each other, and from both
// ends, are two differences. The states are partners of those that hold as much.
TEST(Differences, StatesThatLookAlikeForLongAreNotMixedUp) {
  constexpr StateId most = 300;
  Mealy left({"write", "read"}, {"quiet", "message", "refused", "unexplored"}, most + 1);
  for (StateId held = 0; held <= most; ++held) {
    left.set_transition(held, 0, held < most ? 0 : 3, std::min(held + 1, most));
    left.set_transition(held, 1, held > 0 ? 1 : 2, held > 0 ? held - 1 : 0);
  }
  Mealy right = left;
  right.set_transition(150, 1, 1, 140);
  right.set_transition(200, 0, 2, 201);
  const Found found = find(left, right);
  EXPECT_THAT(found.differences.list, SizeIs(2));
  for (StateId state = 0; state < found.pair.left.size; ++state) {
    ASSERT_NE(found.differences.left_partners[state], Mealy::no_state);
    EXPECT_EQ(found.pair.left.origins[state],
              found.pair.right.origins[found.differences.left_partners[state]]);
  }
}

TEST(Differences, AnInputThatOneHasIsOne) {
  Mealy left({"a"}, {"x", "y"}, 2);
  left.set_transition(0, 0, 0, 1);
  left.set_transition(1, 0, 1, 0);
  Mealy right({"b", "a"}, {"x", "y"}, 2);
  for (StateId state = 0; state < 2; ++state) {
    right.set_transition(state, 0, 0, state);
    right.set_transition(state, 1, state, 1 - state);
  }
  const Found found = find(left, right);
  ASSERT_THAT(found.differences.list, SizeIs(1));
  EXPECT_EQ(found.question(0), "b");
  EXPECT_EQ(found.differences.list[0].left, "no such input");
}

// The start is a state further: every state has its equivalent, and one word tells the starts.
TEST(Differences, AnotherStartIsOne) {
  const Mealy left = ring(5);
  Mealy right = left;
  right.set_initial(1);
  const Found found = find(left, right);
  ASSERT_THAT(found.differences.list, SizeIs(1));
  EXPECT_THAT(word_of(found, found.differences.list[0]), ElementsAre("b"));
}

TEST(Differences, WhatWasNeverTriedIsABound) {
  Mealy left({"a"}, {"x", "unexplored"}, 2);
  left.set_transition(0, 0, 0, 1);
  left.set_transition(1, 0, 1, 1);
  Mealy right({"a"}, {"x"}, 1);
  right.set_transition(0, 0, 0, 0);
  const Found found = find(left, right);
  ASSERT_THAT(found.differences.list, SizeIs(1));
  EXPECT_TRUE(found.differences.list[0].is_bound);
  EXPECT_EQ(found.differences.list[0].left, "never tried");
}

TEST(Differences, AutomataWithOtherBounds) {
  const Found found = find("strict-3", "strict-6");
  ASSERT_THAT(found.differences.list, SizeIs(1));
  const Difference& difference = found.differences.list[0];
  EXPECT_TRUE(difference.is_bound);
  EXPECT_THAT(difference.way, SizeIs(3));
  EXPECT_EQ(found.question(0), "?write");
  EXPECT_EQ(difference.right, "enabled");
  EXPECT_THAT(find("strict-3-tryread", "strict-3-tryread-absorb").differences.list, IsEmpty());
}

// One answers, the other does not: one difference, and not another for each input that the one
// refuses until its output is out. Both go on behind it.
TEST(Differences, WhatComesOutIsOneDifference) {
  const Action a{Action::Kind::input, 0}, x{Action::Kind::output, 0}, b{Action::Kind::input, 1};
  InterfaceAutomaton left({"a", "b"}, {"x"}, 3);
  left.add_transition(0, a, 1);
  left.add_transition(1, x, 2);
  left.add_transition(2, b, 0);
  InterfaceAutomaton right({"a", "b"}, {"x"}, 2);
  right.add_transition(0, a, 1);
  right.add_transition(1, b, 0);
  right.add_transition(1, a, 0);
  BehaviourPair pair = read_behaviours(left, right);
  const Differences differences = find_differences(pair);
  ASSERT_THAT(differences.list, SizeIs(2));
  EXPECT_EQ(differences.list[0].left, "x");
  EXPECT_EQ(differences.list[0].right, "nothing");
  // Behind it: ?a is refused on the left.
  EXPECT_EQ(pair.questions[differences.list[1].question], "?a");
  ASSERT_THAT(differences.list[1].way, SizeIs(2));
  EXPECT_EQ(differences.list[1].way[1].left, "!x");
  EXPECT_EQ(differences.list[1].way[1].right, "");
  EXPECT_FALSE(differences.list[1].way[1].agrees);
}

// On random mutants: nothing exactly if they are equivalent, a shortest word first, and each word
// has other answers at its end. No pair and input comes twice.
TEST(Differences, AgreeWithAPlainComparison) {
  Random random(5);
  std::size_t several = 0, different = 0;
  for (int round = 0; round < 400; ++round) {
    const Mealy left = random_mealy({2 + random.below(20), 2 + random.below(3), 3}, random);
    const Mealy right = mutate(left, random.below(4), random);
    const Found found = find(left, right);
    const auto expected = find_difference(left, right);
    ASSERT_EQ(found.differences.list.empty(), !expected);
    if (!expected) continue;
    EXPECT_EQ(word_of(found, found.differences.list.front()), expected->word);
    std::set<std::vector<StateId>> places;
    for (const Difference& difference : found.differences.list) {
      const std::vector<std::string> word = word_of(found, difference);
      const auto left_outputs = play(left, word), right_outputs = play(right, word);
      EXPECT_EQ(left_outputs.back(), difference.left);
      EXPECT_EQ(right_outputs.back(), difference.right);
      EXPECT_NE(difference.left, difference.right);
      std::size_t passed = 0;
      for (std::size_t i = 0; i + 1 < word.size(); ++i) {
        passed += left_outputs[i] != right_outputs[i] ? 1 : 0;
        EXPECT_EQ(difference.way[i].agrees, left_outputs[i] == right_outputs[i]);
      }
      EXPECT_EQ(passed, difference.passed());
      EXPECT_TRUE(places
                      .insert({difference.left_state, difference.right_state,
                               static_cast<StateId>(difference.question)})
                      .second);
    }
    ++different;
    several += found.differences.list.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(different, 150U);
  EXPECT_GT(several, 50U);
}

// One change of one output in a machine without equivalent states is one difference.
TEST(Differences, AMutantWithOneOtherOutputHasOne) {
  Random random(6);
  std::size_t one = 0;
  for (int round = 0; round < 200; ++round) {
    const Mealy left = minimize(random_mealy({15, 3, 3}, random));
    Mealy right = left;
    const auto state = static_cast<StateId>(random.below(left.size()));
    right.set_transition(state, 1, (left.output(state, 1) + 1) % 3, left.target(state, 1));
    const Found found = find(left, right);
    ASSERT_FALSE(found.differences.list.empty());
    one += found.differences.list.size() == 1 ? 1 : 0;
  }
  EXPECT_GE(one, 190U) << "of 200";
}

// Two machines that have nothing in common meet in nearly all pairs of states.
TEST(Differences, MachinesThatFallOutOfStepAreNotLookedAtWhole) {
  Random random(7);
  const Mealy left = random_mealy({600, 2, 2}, random), right = random_mealy({600, 2, 2}, random);
  const Found found = find(left, right);
  EXPECT_FALSE(found.differences.is_complete);
  EXPECT_EQ(found.differences.pairs, most_pairs(found.pair));
  EXPECT_LT(found.differences.pairs, found.pair.left.size * found.pair.right.size);
  ASSERT_FALSE(found.differences.list.empty());
  EXPECT_EQ(word_of(found, found.differences.list.front()).size(),
            find_difference(left, right)->word.size());
  EXPECT_TRUE(find(left, left).differences.is_complete);
}

}  // namespace
}  // namespace maide
