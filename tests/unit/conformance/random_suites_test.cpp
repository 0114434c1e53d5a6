// Random suites: their ranges, their lengths, and that a seed means a run.
#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/conformance/random_walk.hpp"
#include "maide/conformance/random_words.hpp"
#include "maide/learn/mealy_oracle.hpp"

namespace maide {
namespace {

TEST(RandomWordSuite, LengthsAndInputsCoverTheirRanges) {
  RandomWordSuite suite(3, 2, 5, Random(1)), again(3, 2, 5, Random(1));
  Word word, same;
  std::vector<int> lengths(6), inputs(3);
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(suite.next(word));
    again.next(same);
    ASSERT_EQ(word, same);
    ++lengths.at(word.size());
    for (const Symbol input : word) ++inputs.at(input);
  }
  EXPECT_EQ(lengths[0] + lengths[1], 0);
  for (std::size_t length = 2; length <= 5; ++length) EXPECT_NEAR(lengths[length], 500, 100);
  for (const int count : inputs) EXPECT_NEAR(count, 7000 / 3, 200);
}

TEST(RandomWalkSuite, PiecesHaveTheExpectedLengthAndStepsAreCounted) {
  RandomWalkSuite suite(2, 0.2, 1000, 10'000, Random(1));
  Word word;
  std::size_t steps = 0, pieces = 0;
  while (suite.next(word)) {
    ASSERT_FALSE(word.empty());
    steps += word.size();
    ++pieces;
  }
  EXPECT_EQ(steps, 10'000U);
  EXPECT_NEAR(static_cast<double>(pieces), 2000, 150);
  EXPECT_FALSE(suite.next(word));
}

TEST(RandomWalkSuite, WithoutRestartsPiecesHaveTheirMaximum) {
  RandomWalkSuite suite(2, 0, 30, 100, Random(1));
  std::vector<std::size_t> lengths;
  Word word;
  while (suite.next(word)) lengths.push_back(word.size());
  EXPECT_EQ(lengths, (std::vector<std::size_t>{30, 30, 30, 10}));
}

Mealy single_state() {
  Mealy machine({"a", "b"}, {"0"}, 1);
  machine.set_transition(0, 0, 0, 0);
  machine.set_transition(0, 1, 0, 0);
  return machine;
}

// Remembers the words.
class Recorder : public MealyOracle {
 public:
  using MealyOracle::ask;
  using MealyOracle::MealyOracle;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    for (const Query& query : batch) words.push_back(std::get<Word>(query));
    return MealyOracle::ask(batch, control, sink);
  }
  std::vector<Word> words;
};

template <typename Method, typename Options>
std::vector<Word> words_of(Options options, int queries) {
  const Mealy machine = single_state();
  Recorder recorder(machine);
  Method method(recorder, options);
  for (int i = 0; i < queries; ++i) method.find_counterexample(machine);
  return recorder.words;
}

TEST(RandomMethods, EachQueryDrawsAnewAndTheSameSeedIsTheSameRun) {
  RandomWordsOptions words{.max_tests = 50, .seed = 3};
  const auto once = words_of<RandomWords>(words, 1), twice = words_of<RandomWords>(words, 2);
  EXPECT_EQ(once.size(), 50U);
  ASSERT_EQ(twice.size(), 100U);
  EXPECT_TRUE(std::equal(once.begin(), once.end(), twice.begin()));
  EXPECT_FALSE(std::equal(once.begin(), once.end(), twice.begin() + 50));
  EXPECT_EQ(twice, words_of<RandomWords>(words, 2));
  // The batch changes nothing.
  words.batch_size = 7;
  EXPECT_EQ(twice, words_of<RandomWords>(words, 2));

  const RandomWalkOptions walk{.max_steps = 500, .seed = 3};
  const auto walked = words_of<RandomWalk>(walk, 2);
  EXPECT_EQ(walked, words_of<RandomWalk>(walk, 2));
  EXPECT_NE(walked, words_of<RandomWalk>(RandomWalkOptions{.max_steps = 500, .seed = 4}, 2));
}

TEST(RandomMethods, SayWhatTheyDid) {
  const Mealy machine = single_state();
  MealyOracle oracle(machine);
  RandomWords words(oracle, {.max_tests = 20, .max_length = 9});
  words.find_counterexample(machine);
  EXPECT_EQ(words.guarantee(), "not refuted by 20 random words of length 1 to 9");
}

}  // namespace
}  // namespace maide
