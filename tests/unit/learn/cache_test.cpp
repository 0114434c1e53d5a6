#include "maide/learn/cache/cache.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "oracles.hpp"

namespace maide {
namespace {

Mealy machine_of(std::uint64_t seed, std::size_t states = 12) {
  Random random(seed);
  return random_mealy({.states = states, .inputs = 3, .outputs = 3}, random);
}

Word random_word(Random& random, std::size_t max_length) {
  Word word(random.below(max_length + 1));
  for (Symbol& input : word) input = static_cast<Symbol>(random.below(3));
  return word;
}

// A tree of a random shape; some outputs have no branch.
DecisionTree random_tree(Random& random, std::size_t depth) {
  DecisionTree tree;
  struct Open {
    std::uint32_t node;
    std::size_t depth;
  };
  std::vector<Open> open{{0, depth}};
  tree.nodes.emplace_back().input = static_cast<Symbol>(random.below(3));
  while (!open.empty()) {
    const Open at = open.back();
    open.pop_back();
    if (at.depth == 0) continue;
    for (Symbol output = 0; output < 3; ++output) {
      if (random.chance(0.4)) continue;
      const auto child = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes.emplace_back().input = static_cast<Symbol>(random.below(3));
      tree.nodes[at.node].branches.emplace_back(output, child);
      open.push_back({child, at.depth - 1});
    }
  }
  return tree;
}

TEST(Cache, IsATransparentFilterForWordsAndTrees) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Mealy machine = machine_of(seed);
    MealyOracle plain(machine);
    RecordingOracle system(machine);
    Cache cache(system);
    Random random(seed);
    std::set<Word> known;  // every prefix of what was asked and answered
    for (int round = 0; round < 30; ++round) {
      std::vector<Query> batch;
      // Every other batch begins alike, as what learners ask of a state: its words are looked up in
      // another way.
      const Word stem = round % 2 == 0 ? Word{} : random_word(random, 6);
      for (std::uint64_t i = random.between(1, 12); i > 0; --i) {
        if (random.chance(0.3)) {
          batch.emplace_back(random_tree(random, 3));
          continue;
        }
        Word word = stem;
        const Word rest = random_word(random, stem.empty() ? 6 : 2);
        word.insert(word.end(), rest.begin(), rest.end());
        batch.emplace_back(std::move(word));
      }
      system.asked.clear();
      const auto expected = plain.ask(batch), answers = cache.ask(batch);
      for (const Query& query : system.asked) {
        const Word path = plain.ask(std::span(&query, 1)).front().inputs;
        EXPECT_FALSE(known.contains(path)) << "asked though known";
      }
      for (std::size_t i = 0; i < batch.size(); ++i) {
        ASSERT_EQ(answers[i].inputs, expected[i].inputs);
        ASSERT_EQ(to_string(answers[i].outputs, cache.outputs()),
                  to_string(expected[i].outputs, machine.outputs()));
        ASSERT_EQ(answers[i].end, WordEnd::complete);
        for (std::size_t length = 0; length <= answers[i].inputs.size(); ++length) {
          known.emplace(answers[i].inputs.begin(),
                        answers[i].inputs.begin() + static_cast<std::ptrdiff_t>(length));
        }
      }
    }
    EXPECT_EQ(cache.observation_count() + 1, known.size());
  }
}

TEST(Cache, AsksPrefixesAndDuplicatesOfABatchOnce) {
  const Mealy machine = machine_of(1);
  RecordingOracle system(machine);
  Cache cache(system);
  const std::vector<Query> batch{Word{0, 1},    Word{2, 2, 1}, Word{0, 1, 2}, Word{0, 1, 2},
                                 Word{2, 2, 1}, Word{2},       Word{},        Word{1}};
  const auto answers = cache.ask(batch);
  ASSERT_EQ(system.asked.size(), 3U);
  EXPECT_EQ(std::get<Word>(system.asked[0]), (Word{2, 2, 1}));
  EXPECT_EQ(std::get<Word>(system.asked[1]), (Word{0, 1, 2}));
  EXPECT_EQ(std::get<Word>(system.asked[2]), (Word{1}));
  EXPECT_EQ(cache.misses(), 3U);
  EXPECT_EQ(cache.hits(), 5U);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    EXPECT_EQ(answers[i].outputs, machine.output_word(std::get<Word>(batch[i])));
  }
}

// A read of nothing blocks the reader until something is written.
Mealy port() {
  Mealy machine(Alphabet({"write", "read"}), Alphabet({"quiet", "message", "refused"}), 3);
  constexpr Symbol write = 0, read = 1, quiet = 0, message = 1, refused = 2;
  machine.set_transition(0, write, quiet, 1);
  machine.set_transition(0, read, quiet, 2);
  machine.set_transition(1, write, quiet, 1);
  machine.set_transition(1, read, message, 0);
  machine.set_transition(2, write, message, 0);
  machine.set_transition(2, read, refused, 2);
  return machine;
}

TEST(Cache, KnowsThatARefusalChangesNothing) {
  constexpr Symbol write = 0, read = 1;
  const Mealy machine = port();
  RecordingOracle system(machine);
  Cache cache(system, Cache::Refusals::change_nothing);
  const auto texts = [&](const Word& word) { return to_string(cache.ask(word), cache.outputs()); };
  EXPECT_EQ(texts({read, read, write}), "quiet refused message");
  for (int i = 0; i < 2; ++i) texts({read, read, write});  // the first two are asked as they are
  EXPECT_EQ(system.asked.size(), 3U);
  EXPECT_EQ(texts({read, write}), "quiet message");
  EXPECT_EQ(texts({read, read, read, write}), "quiet refused refused message");
  EXPECT_EQ(system.asked.size(), 3U) << "known";
  texts({read, read, write});  // the fourth, asked as it is
  EXPECT_EQ(texts({read, read, read, write, write}), "quiet refused refused message quiet");
  EXPECT_EQ(std::get<Word>(system.asked.back()), (Word{read, write, write}));
  const std::vector<Query> tree{
      chain(Word{read, read, write, read, read, read},
            Word{cache.intern_output("quiet"), cache.intern_output("refused"),
                 cache.intern_output("message"), cache.intern_output("quiet"),
                 cache.intern_output("refused")})};
  const MealyAnswer answer = cache.ask(tree).front();
  EXPECT_EQ(answer.inputs, (Word{read, read, write, read, read, read}));
  EXPECT_EQ(to_string(answer.outputs, cache.outputs()),
            "quiet refused message quiet refused refused");
  EXPECT_EQ(std::get<DecisionTree>(system.asked.back()).nodes.size(), 5U);
  cache.check_invariants();
}

// The second read that is refused ends the reader.
TEST(Cache, FindsARefusalThatChangesSomething) {
  constexpr Symbol write = 0, read = 1, quiet = 0, refused = 2;
  Mealy machine = port();
  const StateId gone = machine.add_state();
  machine.set_transition(2, read, refused, gone);
  machine.set_transition(gone, write, quiet, gone);
  machine.set_transition(gone, read, refused, gone);
  MealyOracle system(machine);
  Cache cache(system, Cache::Refusals::change_nothing);
  cache.ask(Word{read, write});
  cache.ask(Word{read, read});
  EXPECT_THROW(cache.ask(Word{read, read, write}), NondeterminismError);
}

// Outputs get their numbers in query order, as without a cache, whatever was recorded first.
TEST(Cache, NumbersOutputsInTheOrderOfQueries) {
  ScriptedOracle system({"a", "b"}, {});
  system.script = [&](std::span<const Query> batch, const OutputOracle::PartialSink&) {
    std::vector<MealyAnswer> answers;
    for (const Query& query : batch) {
      MealyAnswer& answer = answers.emplace_back();
      answer.inputs = std::get<Word>(query);
      for (const Symbol input : answer.inputs) {
        answer.outputs.push_back(system.intern_output(input == 0 ? "zero" : "one"));
      }
    }
    return answers;
  };
  Cache cache(system);
  const std::vector<Query> batch{Word{1}, Word{0, 1}, Word{1, 1}};
  cache.ask(batch);  // the system is asked {0, 1} first
  EXPECT_EQ(cache.outputs(), Alphabet({"one", "zero"}));
  EXPECT_EQ(system.outputs(), Alphabet({"zero", "one"}));
}

ScriptedOracle::Script answer_all(const Word& outputs) {
  return [outputs](std::span<const Query> batch, const OutputOracle::PartialSink&) {
    std::vector<MealyAnswer> answers(batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
      answers[i].inputs = std::get<Word>(batch[i]);
      answers[i].outputs.assign(
          outputs.begin(), outputs.begin() + static_cast<std::ptrdiff_t>(answers[i].inputs.size()));
    }
    return answers;
  };
}

TEST(Cache, AContradictionShowsTheWordAndBothAnswers) {
  ScriptedOracle system({"write", "read"}, {"quiet", "message", "null"});
  system.script = answer_all({0, 1});
  Cache cache(system);
  cache.ask(Word{0, 1});
  system.script = answer_all({0, 2, 0});
  try {
    cache.ask(Word{0, 1, 1});
    FAIL() << "not noticed";
  } catch (const NondeterminismError& error) {
    EXPECT_EQ(error.word(), "write read");
    EXPECT_EQ(error.first_answer(), "quiet message");
    EXPECT_EQ(error.second_answer(), "quiet null");
  }
  // The first answer stays.
  EXPECT_EQ(cache.ask(Word{0, 1}), (Word{0, 1}));
  EXPECT_EQ(cache.observation_count(), 2U);
}

TEST(Cache, KeepsWhatWasAnsweredBeforeAnException) {
  const Mealy machine = machine_of(2);
  MealyOracle plain(machine);
  ScriptedOracle system(machine.inputs(), machine.outputs());
  system.script = [&](std::span<const Query> batch,
                      const OutputOracle::PartialSink& sink) -> std::vector<MealyAnswer> {
    sink(1, plain.ask(batch.subspan(1, 1)).front());
    throw WrapperError("it died", "test");
  };
  Cache cache(system);
  const std::vector<Query> batch{Word{0, 0, 0}, Word{1, 1, 1}, Word{2}, Word{1, 1}};
  std::vector<std::size_t> handed_over;
  EXPECT_THROW(cache.ask(batch, {},
                         [&](std::size_t index, const MealyAnswer& answer) {
                           handed_over.push_back(index);
                           EXPECT_EQ(answer.outputs,
                                     machine.output_word(std::get<Word>(batch[index])));
                         }),
               WrapperError);
  EXPECT_EQ(handed_over, (std::vector<std::size_t>{1, 3}));
  system.script = [](auto, auto) -> std::vector<MealyAnswer> {
    ADD_FAILURE() << "asked again";
    return {};
  };
  EXPECT_EQ(cache.ask(Word{1, 1, 1}), machine.output_word(Word{1, 1, 1}));
}

TEST(Cache, AWordThatEndedEarlyIsNotTakenForComplete) {
  ScriptedOracle system({"a"}, {"x"});
  int asked = 0;
  system.script = [&](std::span<const Query> batch, const OutputOracle::PartialSink&) {
    ++asked;
    MealyAnswer answer;
    answer.inputs = std::get<Word>(batch.front());
    answer.outputs = {0};
    answer.end = WordEnd::hang;
    return std::vector<MealyAnswer>(batch.size(), answer);
  };
  Cache cache(system);
  const std::vector<Query> batch{Word{0, 0, 0}};
  for (int i = 1; i <= 2; ++i) {
    const MealyAnswer answer = cache.ask(batch).front();
    EXPECT_EQ(answer.end, WordEnd::hang);
    EXPECT_EQ(answer.outputs.size(), 1U);
    EXPECT_EQ(asked, i);
  }
  EXPECT_EQ(cache.ask(Word{0}), Word{0});  // what was seen is known
  EXPECT_EQ(asked, 2);
}

// Against all words asked, one by one.
TEST(CacheConsistency, FindsTheLeastKnownWordThatIsWrong) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Mealy machine = machine_of(seed, 6), hypothesis = machine_of(seed + 1000, 3);
    MealyOracle system(machine);
    Cache cache(system);
    Random random(seed);
    std::vector<Word> words;
    for (int i = 0; i < 4; ++i) words.push_back(random_word(random, 4));
    std::optional<Word> least;
    for (const Word& word : words) {
      cache.ask(word);
      for (std::size_t length = 1; length <= word.size(); ++length) {
        const Word prefix(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(length));
        if (machine.output_word(prefix) == hypothesis.output_word(prefix)) continue;
        if (!least || prefix.size() < least->size() ||
            (prefix.size() == least->size() && prefix < *least)) {
          least = prefix;
        }
        break;
      }
    }
    const auto test = cache.make_consistency_test();
    EXPECT_EQ(test->find_counterexample(hypothesis), least);
    EXPECT_EQ(test->find_counterexample(machine), std::nullopt);
    found += least ? 1 : 0;
  }
  EXPECT_GT(found, 50);
  EXPECT_LT(found, 200);
}

TEST(CacheConsistency, RefusesAHypothesisOverOtherInputs) {
  const Mealy machine = machine_of(1);
  MealyOracle system(machine);
  Cache cache(system);
  EXPECT_THROW(cache.make_consistency_test()->find_counterexample(Mealy({"x"}, {"0"}, 1)),
               UsageError);
}

}  // namespace
}  // namespace maide
