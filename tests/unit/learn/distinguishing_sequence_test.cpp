// A sequence that is found tells its states apart; where none can be there, none is found.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "maide/automata/random_automata.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/tree/adt.hpp"

namespace maide {
namespace {

Word outcome(const Mealy& machine, StateId state, const DecisionTree& sequence) {
  MealyAnswer answer;
  play_query(sequence, answer, [&](Symbol input) -> std::optional<Symbol> {
    const Symbol output = machine.output(state, input);
    state = machine.target(state, input);
    return output;
  });
  EXPECT_EQ(inputs_along(sequence, answer.outputs), answer.inputs);
  return answer.outputs;
}

TEST(DistinguishingSequence, EachStateAnswersInItsOwnWay) {
  Random random(1);
  int found = 0;
  for (int i = 0; i < 100; ++i) {
    const Mealy machine = random_mealy({.states = 20, .inputs = 3, .outputs = 2}, random);
    std::set<StateId> chosen;
    while (chosen.size() < 2 + random.below(5)) {
      chosen.insert(static_cast<StateId>(random.below(20)));
    }
    const std::vector<StateId> states(chosen.begin(), chosen.end());
    const auto sequence = find_distinguishing_sequence(machine, states, 1000);
    if (!sequence) continue;
    ++found;
    std::set<Word> outcomes;
    for (const StateId state : states) outcomes.insert(outcome(machine, state, *sequence));
    EXPECT_EQ(outcomes.size(), states.size());
  }
  EXPECT_GT(found, 50);
}

// Three states that an input rotates; the other input answers differently in the last one.
Mealy rotation() {
  Mealy machine(Alphabet({"turn", "look"}), Alphabet({"no", "yes"}), 3);
  for (StateId state = 0; state < 3; ++state) {
    machine.set_transition(state, 0, 0, (state + 1) % 3);
    machine.set_transition(state, 1, state == 2 ? 1 : 0, state);
  }
  return machine;
}

TEST(DistinguishingSequence, WaitsForAWordThatPartsTheStates) {
  const Mealy machine = rotation();
  const auto pair = find_distinguishing_sequence(machine, {0, 1}, 100);
  ASSERT_TRUE(pair);
  EXPECT_EQ(outcome(machine, 0, *pair), (Word{0, 0}));  // turn, look
  EXPECT_EQ(outcome(machine, 1, *pair), (Word{0, 1}));
  EXPECT_TRUE(find_distinguishing_sequence(machine, {0, 1, 2}, 100));
  EXPECT_FALSE(find_distinguishing_sequence(machine, {0, 1}, 1));  // not at once
}

TEST(DistinguishingSequence, ThereIsNoneForStatesThatMerge) {
  Mealy machine = rotation();
  for (StateId state = 0; state < 3; ++state) machine.set_transition(state, 0, 0, 2);
  EXPECT_FALSE(find_distinguishing_sequence(machine, {0, 1}, 1000));
  EXPECT_TRUE(find_distinguishing_sequence(machine, {0, 2}, 1000));
}

TEST(Experiment, GoesOnAfterAnOutcome) {
  DecisionTree tree = chain(Word{0, 1}, Word{5});
  lengthen(tree, Word{5, 6}, chain(Word{2}, {}));
  EXPECT_EQ(inputs_along(tree, Word{4}), (Word{0}));
  EXPECT_EQ(inputs_along(tree, Word{5, 7}), (Word{0, 1}));
  EXPECT_EQ(inputs_along(tree, Word{5, 6, 7}), (Word{0, 1, 2}));
}

}  // namespace
}  // namespace maide
