// The rule by which contradictions are decided keeps what it promises, and the cache follows it.
#include "maide/learn/oracle/vote.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "oracles.hpp"

namespace maide {
namespace {

TEST(Ballot, UnanimousOutputsDecideAsSoonAsTheConfidenceAllows) {
  for (const auto& [confidence, needed] :
       {std::pair{0.9, 5U}, std::pair{0.99, 10U}, std::pair{0.999, 15U}}) {
    Ballot ballot({.confidence = confidence, .most_attempts = 60});
    EXPECT_EQ(ballot.missing(), needed);
    for (std::uint32_t i = 0; i < needed; ++i) {
      EXPECT_FALSE(ballot.winner().has_value());
      ballot.add(7);
    }
    EXPECT_EQ(ballot.winner(), 7U);
    EXPECT_EQ(ballot.missing(), 0U);
    EXPECT_FALSE(ballot.is_nondeterministic());
  }
}

TEST(Ballot, OptionsThatCannotBeAreRefused) {
  EXPECT_THROW(Ballot({.confidence = 0, .most_attempts = 60}), UsageError);
  EXPECT_THROW(Ballot({.confidence = 1, .most_attempts = 60}), UsageError);
  EXPECT_THROW(Ballot({.confidence = 0.99, .most_attempts = 9}), UsageError);
  EXPECT_NO_THROW(Ballot({.confidence = 0.99, .most_attempts = 10}));
}

// Votes until the end; the output decided on, or nothing.
std::optional<Symbol> vote(const VoteOptions& options, Random& random, double wrong) {
  Ballot ballot(options);
  while (ballot.missing() > 0 && !ballot.is_nondeterministic()) {
    ballot.add(random.chance(wrong) ? static_cast<Symbol>(1 + random.below(2)) : 0);
  }
  return ballot.winner();
}

TEST(Ballot, WrongOutputsWinAsRarelyAsIsSaid) {
  Random random(1);
  constexpr int votes = 2000;
  for (const double noise : {0.05, 0.2, 0.3, 0.49}) {
    int wrong = 0, undecided = 0;
    for (int i = 0; i < votes; ++i) {
      const auto winner = vote({.confidence = 0.95, .most_attempts = 60}, random, noise);
      undecided += winner ? 0 : 1;
      wrong += winner.value_or(0) != 0 ? 1 : 0;
    }
    EXPECT_LE(wrong, 0.05 * votes + 40) << noise;  // four standard deviations
    if (noise <= 0.05) {
      EXPECT_EQ(undecided, 0);
    }
    if (noise >= 0.49) {
      EXPECT_GT(undecided, votes / 2);
    }
  }
}

TEST(Ballot, LaterOutputsMayUndoADecision) {
  Ballot ballot(VoteOptions{});
  for (int i = 0; i < 10; ++i) ballot.add(0);
  EXPECT_EQ(ballot.winner(), 0U);
  for (int i = 0; i < 60; ++i) ballot.add(1);
  EXPECT_EQ(ballot.winner(), 1U);
  EXPECT_EQ(ballot.counts().at(1), 60U);
  for (int i = 0; i < 50; ++i) ballot.add(0);
  EXPECT_TRUE(ballot.is_nondeterministic());
}

// A machine of two states, "a" toggles and answers the state left; some runs are spoilt.
class SpoiltOracle : public OutputOracle {
 public:
  using OutputOracle::ask;
  // `spoil` changes the outputs of the n-th run.
  explicit SpoiltOracle(std::function<void(std::uint64_t run, Word& outputs)> spoil)
      : spoil_(std::move(spoil)) {}
  const Alphabet& inputs() const override { return inputs_; }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override { return outputs_.intern(name); }
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl&,
                               const PartialSink&) override {
    std::vector<MealyAnswer> answers;
    for (const Query& query : batch) {
      MealyAnswer answer;
      answer.inputs = std::get<Word>(query);
      for (std::size_t i = 0; i < answer.inputs.size(); ++i) answer.outputs.push_back(i % 2);
      spoil_(runs++, answer.outputs);
      answers.push_back(std::move(answer));
    }
    return answers;
  }
  std::uint64_t runs = 0;

 private:
  std::function<void(std::uint64_t, Word&)> spoil_;
  Alphabet inputs_{"a"}, outputs_{"0", "1", "2"};
};

const Word one{0}, two{0, 0}, three{0, 0, 0};

TEST(CacheVotes, AFreshAnswerThatIsWrongIsAskedAgainAndNobodyNotices) {
  SpoiltOracle system([](std::uint64_t run, Word& outputs) {
    if (run == 1) outputs[0] = 2;
  });
  Cache cache(system);
  cache.hold_votes({});
  EXPECT_EQ(cache.ask(two), (Word{0, 1}));
  EXPECT_EQ(cache.ask(three), (Word{0, 1, 0}));
  EXPECT_EQ(system.runs, 1U + 1U + 10U + 1U);
  const auto contradictions = cache.contradictions();
  ASSERT_EQ(contradictions.size(), 1U);
  EXPECT_EQ(contradictions[0].word, "a");
  EXPECT_EQ(to_string(contradictions[0]), "a: 12 times \"0\", 1 time \"2\"");
}

TEST(CacheVotes, AWrongAnswerInTheTreeIsCorrectedAndWhoeverSawItIsTold) {
  SpoiltOracle system([](std::uint64_t run, Word& outputs) {
    if (run == 0) outputs[1] = 2;
  });
  Cache cache(system);
  cache.hold_votes({});
  EXPECT_EQ(cache.ask(three), (Word{0, 2, 0}));
  EXPECT_THROW(cache.ask_afresh(three), CacheCorrected);
  const std::uint64_t runs = system.runs;
  EXPECT_EQ(cache.ask(three), (Word{0, 1, 0}));
  EXPECT_EQ(system.runs, runs);
  EXPECT_EQ(cache.observation_count(), 3U);
}

TEST(CacheVotes, AnEarlierMistakeIsSettledBeforeALaterOne) {
  // The first run is wrong from the first input on: the vote on it forgets what is behind it.
  SpoiltOracle system([](std::uint64_t run, Word& outputs) {
    if (run == 0) std::fill(outputs.begin(), outputs.end(), Symbol{2});
    if (run == 3) outputs[0] = 1;
  });
  Cache cache(system);
  cache.hold_votes({});
  EXPECT_EQ(cache.ask(three), (Word{2, 2, 2}));
  EXPECT_THROW(cache.ask_afresh(three), CacheCorrected);
  EXPECT_EQ(cache.ask(three), (Word{0, 1, 0}));
}

TEST(CacheVotes, TreeAndFileSayTheSame) {
  const TempDir folder;
  const auto spoil = [](std::uint64_t run, Word& outputs) {
    if (run % 7 == 0) outputs[outputs.size() / 2] = 2;
  };
  SpoiltOracle system(spoil);
  {
    CacheFile file(folder.path() / "cache", system.inputs(), {});
    Cache cache(system, file);
    cache.hold_votes({});
    Word word;
    for (int length = 1; length < 60; ++length) {
      word.push_back(0);
      try {
        cache.ask_afresh(word);
      } catch (const CacheCorrected&) {
        continue;
      }
    }
    EXPECT_FALSE(cache.contradictions().empty());
  }
  SpoiltOracle silent([](std::uint64_t, Word&) { FAIL() << "asked again"; });
  CacheFile file(folder.path() / "cache", system.inputs(), {});
  Cache cache(silent, file);  // throws if the file contradicts itself
  const Word outputs = cache.ask(Word(50, 0));
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    EXPECT_EQ(cache.outputs().name(outputs[i]), i % 2 == 0 ? "0" : "1") << i;
  }
}

TEST(CacheVotes, WhatStaysUndecidedIsNondeterministic) {
  SpoiltOracle system([](std::uint64_t run, Word& outputs) {
    if (outputs.size() > 1 && run % 2 == 0) outputs[1] = 2;
  });
  Cache cache(system);
  cache.hold_votes({.confidence = 0.99, .most_attempts = 40});
  EXPECT_EQ(cache.ask(two), (Word{0, 2}));
  try {
    cache.ask(three);
    FAIL() << "believed";
  } catch (const NondeterminismError& error) {
    EXPECT_EQ(error.status(), ExitStatus::inconclusive);
    EXPECT_EQ(error.word(), "a a");
    EXPECT_STREQ(
        error.what(),
        "the system stays nondeterministic: it answered \"a a\" 21 times \"0 1\", 21 "
        "times \"0 2\"; give it longer waits, or, if it is like that, learn it with --algorithm "
        "nstar (for some 44 times as many words)");
  }
}

TEST(CacheVotes, WithoutThemAContradictionEndsTheRunAtOnce) {
  SpoiltOracle system([](std::uint64_t run, Word& outputs) {
    if (run == 1) outputs[0] = 2;
  });
  Cache cache(system);
  cache.ask(two);
  EXPECT_THROW(cache.ask(three), NondeterminismError);
  EXPECT_EQ(system.runs, 2U);
}

}  // namespace
}  // namespace maide
