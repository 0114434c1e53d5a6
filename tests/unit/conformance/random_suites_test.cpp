// Random suites: their ranges, their lengths, and that a seed means a run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/random_identifier_suite.hpp"
#include "maide/conformance/suite/random_words.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

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

// Every test is a state's word, an infix within the law, and an identifier of where that leads.
TEST(RandomIdentifierSuite, TestsAreMadeOfTheirThreeParts) {
  Random random(2);
  const Mealy machine = minimize(random_mealy({.states = 20, .inputs = 3, .outputs = 2}, random));
  const StateIdentifiers identifiers = compute_adaptive_words(machine, Random(1));
  RandomIdentifierSuite suite(machine, identifiers, {2, 3}, Random(1));
  const std::vector<Word> cover = compute_state_cover(machine);
  std::set<std::size_t> starts;
  Word word;
  double symbols = 0, expected = 0;
  for (int i = 0; i < 5000; ++i) {
    ASSERT_TRUE(suite.next(word));
    symbols += static_cast<double>(word.size());
    bool has_parts = false;
    for (std::size_t start = 0; start < cover.size(); ++start) {
      if (word.size() < cover[start].size() + 2 ||
          !std::equal(cover[start].begin(), cover[start].end(), word.begin())) {
        continue;
      }
      starts.insert(start);
      for (std::size_t end = cover[start].size() + 2; end <= word.size(); ++end) {
        const Word suffix(word.begin() + static_cast<std::ptrdiff_t>(end), word.end());
        const auto own = identifiers.of(machine.run(std::span(word).first(end)));
        has_parts = has_parts || std::find(own.begin(), own.end(), suffix) != own.end();
      }
    }
    EXPECT_TRUE(has_parts) << to_string(word, machine.inputs());
  }
  EXPECT_EQ(starts.size(), cover.size());
  for (const Word& access : cover) expected += static_cast<double>(access.size());
  expected = expected / static_cast<double>(cover.size()) + 2 + 3;
  EXPECT_GT(symbols / 5000, expected);
  EXPECT_LT(symbols / 5000, expected + 10);
}

// Tests without an infix show their ends.
TEST(RandomIdentifierSuite, BeginsAndEndsByItsLaws) {
  // A chain of ten states; only its last input tells the last state.
  Mealy chain({"on", "back", "look"}, {"0", "end"}, 10);
  for (StateId state = 0; state < 10; ++state) {
    chain.set_transition(state, 0, 0, std::min<StateId>(state + 1, 9));
    chain.set_transition(state, 1, 0, 0);
    chain.set_transition(state, 2, state == 9 ? 1 : 0, state);
  }
  const StateIdentifiers identifiers = compute_adaptive_words(chain, Random(1));
  constexpr int tests = 20'000;
  const auto draw = [&](TestEnds ends) {
    RandomIdentifierSuite suite(chain, identifiers, {.min = 0, .mean = 0}, Random(1), {}, ends);
    std::map<Word, int> words;
    Word word;
    for (int i = 0; i < tests; ++i) {
      EXPECT_TRUE(suite.next(word));
      ++words[word];
    }
    return words;
  };
  auto prefixes = draw({PrefixStates::uniform, SuffixWords::none});
  EXPECT_EQ(prefixes.size(), 10U);
  for (const auto& [word, count] : prefixes) EXPECT_NEAR(count, tests / 10, 300);
  prefixes = draw({PrefixStates::deep, SuffixWords::none});
  EXPECT_EQ(prefixes.size(), 10U);
  for (const auto& [word, count] : prefixes) {  // of two, the farther one: 2 i + 1 of 100 pairs
    EXPECT_NEAR(count, tests * (2 * static_cast<int>(word.size()) + 1) / 100, 300);
  }
  prefixes = draw({PrefixStates::transitions, SuffixWords::none});
  EXPECT_EQ(prefixes.size(), 30U);
  for (const auto& [word, count] : prefixes) EXPECT_NEAR(count, tests / 30, 200);

  const auto count_foreign = [&](SuffixWords suffix) {
    int foreign = 0;
    for (const auto& [word, count] : draw({PrefixStates::uniform, suffix})) {
      bool is_own = false;
      for (const Word& access : compute_state_cover(chain)) {
        for (const Word& own : identifiers.of(chain.run(access))) {
          Word whole = access;
          whole.insert(whole.end(), own.begin(), own.end());
          is_own = is_own || whole == word;
        }
      }
      foreign += is_own ? 0 : count;
    }
    return foreign;
  };
  EXPECT_EQ(count_foreign(SuffixWords::own), 0);
  EXPECT_GT(count_foreign(SuffixWords::any), tests / 10);
}

// The frequencies of the first inputs are the weights.
TEST(InfixSampler, DrawsWithTheWeightsOfItsLaw) {
  // Of state 0's inputs two lead to a state to which six transitions of three states lead, one to a
  // state to which two lead; in state 1 two inputs of three change nothing.
  Mealy machine({"a", "b", "c"}, {"0"}, 3);
  for (StateId state = 0; state < 3; ++state) {
    machine.set_transition(state, 0, 0, 2);
    machine.set_transition(state, 1, 0, 2);
    machine.set_transition(state, 2, 0, state == 2 ? 0 : 1);
  }
  Mealy controller({"a", "b", "c"}, {"0"}, 2);
  for (StateId state = 0; state < 2; ++state) {
    controller.set_transition(state, 0, 0, state);
    controller.set_transition(state, 1, 0, state);
    controller.set_transition(state, 2, 0, 1 - state);
  }
  Random random(5);
  const auto count = [&](const Mealy& model, InfixInputs inputs) {
    const InfixSampler sampler(model, {.min = 1, .mean = 0, .inputs = inputs}, {});
    std::vector<int> drawn(3);
    for (int i = 0; i < 10'000; ++i) {
      StateId state = 0;
      Word word;
      sampler.draw(state, word, random);
      EXPECT_EQ(state, model.run(word));
      ++drawn.at(word.at(0));
    }
    return drawn;
  };
  for (const int drawn : count(machine, InfixInputs::uniform)) EXPECT_NEAR(drawn, 3333, 200);
  const std::vector<int> off_sinks = count(machine, InfixInputs::off_sinks);  // 1/6, 1/6, 1/2
  EXPECT_NEAR(off_sinks[0], 2000, 200);
  EXPECT_NEAR(off_sinks[1], 2000, 200);
  EXPECT_NEAR(off_sinks[2], 6000, 200);
  const std::vector<int> off_loops = count(controller, InfixInputs::off_loops);  // 1/4, 1/4, 1/2
  EXPECT_NEAR(off_loops[0], 2500, 200);
  EXPECT_NEAR(off_loops[1], 2500, 200);
  EXPECT_NEAR(off_loops[2], 5000, 200);
  // Nothing to replay.
  EXPECT_NEAR(count(machine, InfixInputs::replayed)[2], 6000, 200);
}

Mealy single_state(std::size_t inputs = 2) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < inputs; ++i) names.push_back("i" + std::to_string(i));
  Mealy machine(Alphabet(names), {"0"}, 1);
  for (Symbol input = 0; input < inputs; ++input) machine.set_transition(0, input, 0, 0);
  return machine;
}

TEST(InfixSampler, DrawsFewInputsOrReplaysPieces) {
  const Mealy machine = single_state(30);
  Random random(6);
  const auto draw = [&](InfixInputs inputs, std::span<const Word> counterexamples) {
    const InfixSampler sampler(machine, {.min = 50, .mean = 0, .inputs = inputs}, counterexamples);
    StateId state = 0;
    Word word;
    sampler.draw(state, word, random);
    EXPECT_EQ(word.size(), 50U);
    return word;
  };
  std::set<std::size_t> sizes;
  for (int i = 0; i < 200; ++i) {
    const Word word = draw(InfixInputs::few, {});
    sizes.insert(std::set(word.begin(), word.end()).size());
  }
  EXPECT_EQ(sizes, (std::set<std::size_t>{1, 2, 3, 4}));

  const std::vector<Word> counterexamples{{1, 2, 3}, {7, 8}};
  std::set<Symbol> replayed, starts;
  for (int i = 0; i < 200; ++i) {
    const Word word = draw(InfixInputs::replayed, counterexamples);
    starts.insert(word.front());
    replayed.insert(word.begin(), word.end());
    for (std::size_t j = 0; j + 1 < word.size(); ++j) {
      if (word[j] == 1 || word[j] == 2 || word[j] == 7) {
        EXPECT_EQ(word[j + 1], word[j] + 1);
      }
    }
  }
  EXPECT_EQ(replayed, (std::set<Symbol>{1, 2, 3, 7, 8}));
  EXPECT_EQ(starts, replayed);

  sizes.clear();
  for (int i = 0; i < 200; ++i) {
    const Word word = draw(InfixInputs::mixed, counterexamples);
    sizes.insert(std::set(word.begin(), word.end()).size());
  }
  EXPECT_TRUE(sizes.contains(1)) << "few";
  EXPECT_GT(*sizes.rbegin(), 10U) << "off-sinks, off-loops";
}

TEST(RandomMethod, FindsWhatLiesDeepAndRefusesImpossibleLaws) {
  Mealy hypothesis({"a", "b"}, {"0", "1"}, 1), system({"a", "b"}, {"0", "1"}, 7);
  for (Symbol input = 0; input < 2; ++input) hypothesis.set_transition(0, input, 0, 0);
  for (StateId state = 0; state < 7; ++state) {
    system.set_transition(state, 0, state == 6 ? 1 : 0, std::min<StateId>(state + 1, 6));
    system.set_transition(state, 1, 0, 0);
  }
  MealyOracle oracle(system);
  RandomMethod method(oracle, hads_identifiers, {.infix = {1, 6}, .max_tests = 100'000});
  EXPECT_TRUE(method.find_counterexample(hypothesis));
  EXPECT_THROW(RandomMethod(oracle, hads_identifiers, {.infix = {1, -1}}), UsageError);
  EXPECT_THROW(RandomMethod(oracle, hads_identifiers, {.infix = {1, std::nan("")}}), UsageError);
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

// A ring of `size` states: in each one of 20 inputs goes on, all others change nothing; a further
// input tells the place in the ring. Going on from the last place says "yes". Another ring may lie
// behind it, in which that does not.
Mealy ring(StateId size, StateId rings) {
  Mealy machine = single_state(21);
  machine.intern_output("yes");
  while (machine.size() < std::size_t{size} * rings) machine.add_state();
  for (StateId state = 0; state < machine.size(); ++state) {
    const StateId place = state % size, first = state - place;
    for (Symbol input = 0; input < 20; ++input) machine.set_transition(state, input, 0, state);
    machine.set_transition(state, 20, machine.intern_output("at " + std::to_string(place)), state);
    const bool is_last = place + 1 == size;
    machine.set_transition(state, (place * 7 + 3) % 20, is_last && first == 0 ? 1 : 0,
                           is_last ? first : state + 1);
  }
  return machine;
}

// What the laws are for: an input that counts, and a mode behind inputs that seem to do nothing, in
// which all is as before but for the end of a long sequence.
TEST(RandomMethod, FindsCountersAndModesByTheLawsForThem) {
  const Mealy hypothesis = ring(6, 1);
  Mealy modes = ring(6, 2);
  modes.set_transition(0, 19, 0, 6);
  Mealy counter = hypothesis;
  for (StateId count = 6; count < 14; ++count) {
    counter.add_state();
    for (Symbol input = 0; input < 21; ++input) {
      const Mealy::Cell cell = counter.row(0)[input];
      counter.set_transition(count, input, cell.output, cell.target);
    }
  }
  for (StateId count = 6; count < 14; ++count) {
    counter.set_transition(count == 6 ? 0 : count - 1, 19, count == 13 ? 1 : 0, count);
  }
  counter.set_transition(13, 19, 1, 13);
  const auto finds = [&](const Mealy& system, InfixInputs inputs) {
    MealyOracle oracle(system);
    RandomMethod method(oracle, hads_identifiers,
                        {.infix = {.inputs = inputs}, .max_tests = 20'000, .seed = 1});
    return method.find_counterexample(hypothesis).has_value();
  };
  EXPECT_TRUE(finds(counter, InfixInputs::few));
  EXPECT_TRUE(finds(modes, InfixInputs::off_loops));
  for (const Mealy& system : {counter, modes}) {
    EXPECT_TRUE(finds(system, InfixInputs::mixed));
    EXPECT_FALSE(finds(system, InfixInputs::off_sinks));
    EXPECT_FALSE(finds(system, InfixInputs::uniform));
  }
}

// A counterexample, by whichever test, makes the next one of its kind easy to find.
TEST(RandomIdentifierSuite, ReplaysCounterexamples) {
  const Mealy hypothesis = ring(12, 1);
  Mealy modes = ring(12, 2);
  modes.set_transition(0, 19, 0, 12);
  MealyOracle oracle(modes);
  const auto finds = [&](std::span<const Word> counterexamples) {
    RandomIdentifierSuite suite(hypothesis, compute_adaptive_words(hypothesis, Random(1)),
                                {.mean = 12, .inputs = InfixInputs::replayed}, Random(1),
                                counterexamples);
    return TestRunner(oracle, {.max_tests = 5'000}).run(suite, hypothesis, {}).has_value();
  };
  EXPECT_FALSE(finds({}));
  std::vector<Word> around{{19}};
  for (Symbol place = 0; place < 12; ++place) around[0].push_back((place * 7 + 3) % 20);
  EXPECT_TRUE(finds(around));
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

TEST(RandomMethods, RefuseLengthsThatNobodyMeans) {
  const Mealy machine = single_state();
  MealyOracle oracle(machine);
  EXPECT_THROW(RandomWords(oracle, {.max_length = ~std::size_t{0}}), UsageError);
  EXPECT_THROW(RandomMethod(oracle, hads_identifiers, {.infix = {~std::size_t{0}, 1}}), UsageError);
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
