// What was answered is not asked again, words and decision trees alike.
#include "maide/learn/oracle/observing_oracle.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "oracles.hpp"

namespace maide {
namespace {

// Answers 1 to the second input of a word, 0 to the others.
Mealy second_of_three() {
  Mealy machine(Alphabet({"a"}), Alphabet({"0", "1"}), 3);
  for (StateId state = 0; state < 3; ++state) {
    machine.set_transition(state, 0, state == 1 ? 1 : 0, std::min<StateId>(state + 1, 2));
  }
  return machine;
}

TEST(ObservingOracle, AsksNothingTwice) {
  const Mealy machine = second_of_three();
  RecordingOracle system(machine);
  ObservingOracle oracle(system);
  EXPECT_EQ(oracle.ask(Word{0, 0}), (Word{0, 1}));
  EXPECT_EQ(oracle.ask(Word{0}), (Word{0}));
  const std::vector<Query> batch{Word{0, 0}, chain(Word{0, 0, 0}, Word{0, 0}), Word{0, 0, 0},
                                 chain(Word{0, 0, 0}, Word{0, 1})};
  const std::vector<MealyAnswer> answers = oracle.ask(batch);
  EXPECT_EQ(answers[0].outputs, (Word{0, 1}));
  EXPECT_EQ(answers[1].outputs, (Word{0, 1}));  // a 0 would have been needed to go on
  EXPECT_EQ(answers[2].outputs, (Word{0, 1, 0}));
  EXPECT_EQ(answers[3].outputs, (Word{0, 1, 0}));
  EXPECT_EQ(system.asked.size(), 3U);
  EXPECT_EQ(oracle.output_queries(), 3U);
}

TEST(ObservingOracle, ReportsASystemThatContradictsItself) {
  ScriptedOracle system({"a"}, {"0", "1"});
  Symbol output = 0;
  system.script = [&](std::span<const Query> batch, const OutputOracle::PartialSink&) {
    std::vector<MealyAnswer> answers(batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
      answers[i].inputs = std::get<Word>(batch[i]);
      answers[i].outputs.assign(answers[i].inputs.size(), output);
    }
    return answers;
  };
  ObservingOracle oracle(system);
  oracle.ask(Word{0, 0});
  output = 1;
  EXPECT_EQ(oracle.ask(Word{0, 0}), (Word{0, 0}));  // known
  EXPECT_THROW(oracle.ask(Word{0, 0, 0}), NondeterminismError);
}

}  // namespace
}  // namespace maide
