#include "maide/learn/oracle/mealy_oracle.hpp"

#include <gtest/gtest.h>

#include "maide/automata/random_automata.hpp"

namespace maide {
namespace {

// Words that begin as the one before, its prefixes, the same word again, the empty word.
TEST(MealyOracle, AnswersEachWordOfABatchAsTheMachineDoes) {
  Random random(1);
  const Mealy machine = random_mealy({.states = 20, .inputs = 3, .outputs = 3}, random);
  MealyOracle oracle(machine);
  std::vector<Query> batch;
  Word word;
  for (int i = 0; i < 500; ++i) {
    word.resize(random.below(word.size() + 1));
    for (std::size_t more = random.below(4); more > 0; --more) {
      word.push_back(static_cast<Symbol>(random.below(3)));
    }
    batch.emplace_back(word);
    if (i % 7 == 0) batch.emplace_back(DecisionTree{{{1, {{0, 1}, {1, 1}}}, {2, {}}}});
  }
  const std::vector<MealyAnswer> answers =
      static_cast<OutputOracle&>(oracle).ask(std::span<const Query>(batch));
  ASSERT_EQ(answers.size(), batch.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (const Word* asked = std::get_if<Word>(&batch[i])) {
      ASSERT_EQ(answers[i].inputs, *asked);
    }
    ASSERT_EQ(answers[i].outputs, machine.output_word(answers[i].inputs)) << i;
  }
}

}  // namespace
}  // namespace maide
