// A pool answers what its members would, once each, whoever dies; it stops when it is told to.
#include "maide/sul/sul_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "maide/base/error.hpp"
#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/simulated_sul.hpp"
#include "port_models.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

// A strict port of three messages; dies after `words`.
class MortalSul : public SimulatedSul {
 public:
  explicit MortalSul(std::size_t words = ~std::size_t{0})
      : SimulatedSul(test::strict_port(3), "strict"), words_left_(words) {}

  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (words_left_ == 0) {
        incidents_.add({"it died", "", ""});
        throw WrapperError("it died", "somewhere");
      }
      --words_left_;
      const auto one = [&](std::size_t, SulAnswer answer) { sink(i, std::move(answer)); };
      SimulatedSul::run(batch.subspan(i, 1), one, control);
    }
  }

  SulIncidents incidents() const override { return incidents_; }

 private:
  std::size_t words_left_;
  SulIncidents incidents_;
};

// Answers the first word, then works until it is stopped.
class EndlessSul : public SimulatedSul {
 public:
  explicit EndlessSul(std::atomic<int>& busy)
      : SimulatedSul(test::strict_port(3), "strict"), busy_(busy) {}
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    SimulatedSul::run(batch.first(1), sink, control);
    ++busy_;
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    changed.wait(lock, control.stop, [] { return false; });
    --busy_;
    control.check("endless work");
  }

 private:
  std::atomic<int>& busy_;
};

template <typename Kind, typename... Arguments>
SulPool::Member member(const std::string& name, Arguments&&... arguments) {
  return {name, std::make_unique<Kind>(std::forward<Arguments>(arguments)...)};
}

SulPool make_pool(std::vector<std::size_t> lives, SulPool::Warn warn = {}) {
  std::vector<SulPool::Member> members;
  for (const std::size_t words : lives) {
    members.push_back(member<MortalSul>("m" + std::to_string(members.size()), words));
  }
  return SulPool(std::move(members), std::move(warn));
}

constexpr std::size_t immortal = ~std::size_t{0};

// All words of a length over two inputs.
std::vector<SulQuery> all_words(std::size_t length) {
  std::vector<SulQuery> words;
  for (std::size_t code = 0; code < std::size_t{1} << length; ++code) {
    Word word;
    for (std::size_t i = 0; i < length; ++i) word.push_back(static_cast<Symbol>(code >> i & 1));
    words.push_back({std::move(word), Translation::eager});
  }
  return words;
}

std::vector<std::string> run(Sul& sul, const std::vector<SulQuery>& words,
                             const RunControl& control = {}) {
  std::vector<std::string> answers(words.size());
  sul.run(
      words,
      [&](std::size_t index, const SulAnswer& answer) {
        EXPECT_TRUE(answers.at(index).empty()) << "answered twice";
        for (const SulStep& step : answer.steps) {
          answers[index] += mealy_output(step, Translation::eager) + " ";
        }
      },
      control);
  return answers;
}

TEST(SulPool, AnswersWhatOneSystemAnswers) {
  MortalSul alone;
  const auto words = all_words(9);
  const auto expected = run(alone, words);
  for (const std::size_t count : {1U, 2U, 4U, 8U}) {
    SulPool pool = make_pool(std::vector<std::size_t>(count, immortal));
    EXPECT_EQ(run(pool, words), expected);
    EXPECT_EQ(run(pool, all_words(0)), std::vector<std::string>{""});
    EXPECT_TRUE(run(pool, {}).empty());
  }
}

TEST(SulPool, PurposesGoToAll) {
  SulPool pool = make_pool({immortal, immortal, immortal});
  const std::vector<std::string> sends{"write"}, receives{"message"};
  pool.add_purpose(LearningPurpose::in_flight(1, 0, sends, receives, AtBound::refuse));
  for (const std::string& answer : run(pool, std::vector<SulQuery>(200, {Word{0, 0}, {}}))) {
    EXPECT_EQ(answer, "quiet unexplored ");
  }
}

TEST(SulPool, WhatADeadSystemLeftIsAskedOfTheOthers) {
  MortalSul alone;
  const auto words = all_words(9);
  std::vector<std::string> warnings;
  SulPool pool = make_pool({3, 50, immortal, 0},
                           [&](std::string_view warning) { warnings.emplace_back(warning); });
  EXPECT_EQ(run(pool, words), run(alone, words));
  // A thread that comes late finds nothing to do, and lives.
  EXPECT_EQ(run(pool, words), run(alone, words));
  EXPECT_EQ(warnings.size(), 4U - pool.size());
  EXPECT_EQ(pool.incidents().count, warnings.size());
  for (const std::string& warning : warnings) {
    EXPECT_THAT(warning, testing::MatchesRegex("m[013] is given up.*it died \\(somewhere\\)"));
  }
}

TEST(SulPool, AsksTheNextWhenAllThatTookPartDied) {
  MortalSul alone;
  SulPool pool = make_pool({0, 0, immortal});
  const std::vector<SulQuery> one{{Word{0, 1, 1}, Translation::eager}};
  EXPECT_EQ(run(pool, one), run(alone, one));
  EXPECT_EQ(pool.size(), 1U);
}

TEST(SulPool, TheErrorOfTheLastOneStandsAndWhatWasAnsweredIsHandedOn) {
  SulPool pool = make_pool({10, 20});
  std::set<std::size_t> answered;
  const auto words = all_words(9);
  const auto sink = [&](std::size_t index, const SulAnswer&) { answered.insert(index); };
  EXPECT_THROW(pool.run(words, sink, {}), WrapperError);
  EXPECT_EQ(answered.size(), 30U);
  EXPECT_EQ(pool.size(), 0U);
  EXPECT_THROW(pool.run(words, sink, {}), WrapperError);
  EXPECT_EQ(answered.size(), 30U);
}

TEST(SulPool, StopsAllAndKeepsWhatWasAnswered) {
  std::atomic<int> busy = 0;
  std::vector<SulPool::Member> members;
  for (int i = 0; i < 4; ++i) members.push_back(member<EndlessSul>("endless", busy));
  SulPool pool(std::move(members));
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::size_t answered = 0;
  const auto words = all_words(9);
  EXPECT_THROW(pool.run(
                   words,
                   [&](std::size_t, const SulAnswer&) {
                     if (++answered == 4) stop.request_stop();
                   },
                   control),
               Interrupted);
  EXPECT_EQ(answered, 4U);
  EXPECT_EQ(busy, 0);
  EXPECT_EQ(pool.size(), 4U);
  EXPECT_THROW(pool.run(
                   words, [&](std::size_t, const SulAnswer&) { ++answered; }, control),
               Interrupted);
  EXPECT_EQ(answered, 4U);
}

TEST(SulPool, AnExceptionOfTheSinkStopsAll) {
  std::atomic<int> busy = 0;
  std::vector<SulPool::Member> members;
  for (int i = 0; i < 3; ++i) members.push_back(member<EndlessSul>("endless", busy));
  SulPool pool(std::move(members));
  const auto sink = [](std::size_t, const SulAnswer&) { throw std::length_error("enough"); };
  EXPECT_THROW(pool.run(all_words(9), sink, {}), std::length_error);
  EXPECT_EQ(busy, 0);
}

TEST(SulPool, WhoComesWhileABatchRunsTakesPart) {
  std::atomic<int> busy = 0;
  std::vector<SulPool::Member> members;
  members.push_back(member<EndlessSul>("endless", busy));
  SulPool pool(std::move(members));
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::size_t answered = 0;
  const auto words = all_words(9);
  // The first one answers one word and holds a portion for ever. Whatever else is answered, and
  // only after that, is the newcomer's.
  EXPECT_THROW(pool.run(
                   words,
                   [&](std::size_t, const SulAnswer&) {
                     if (++answered == 1) pool.admit(member<MortalSul>("late"));
                     if (answered == 300) stop.request_stop();
                   },
                   control),
               Interrupted);
  EXPECT_GE(answered, 300U);
  EXPECT_EQ(pool.size(), 2U);
  EXPECT_EQ(pool.most(), 2U);
}

TEST(SulPool, ANewcomerIsGivenThePurposes) {
  std::vector<SulPool::Member> members;
  members.push_back(member<MortalSul>("mortal", 0));
  SulPool pool(std::move(members));
  const std::vector<std::string> sends{"write"}, receives{"message"};
  pool.add_purpose(LearningPurpose::in_flight(1, 0, sends, receives, AtBound::refuse));
  pool.admit(member<MortalSul>("late"));
  for (const std::string& answer : run(pool, std::vector<SulQuery>(50, {Word{0, 0}, {}}))) {
    EXPECT_EQ(answer, "quiet unexplored ");
  }
}

TEST(SulPool, WaitsForAnotherWhenNoneIsLeft) {
  MortalSul alone;
  const auto words = all_words(7);
  std::vector<std::string> warnings;
  std::vector<SulPool::Member> members;
  members.push_back(member<MortalSul>("first", 20));
  SulPool pool(
      std::move(members), [&](std::string_view warning) { warnings.emplace_back(warning); },
      std::chrono::minutes(5));
  {
    const std::jthread comer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      pool.admit(member<MortalSul>("second"));
    });
    EXPECT_EQ(run(pool, words), run(alone, words));
  }
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings[0], testing::StartsWith("first is given up"));
  EXPECT_EQ(warnings[1], "no system is left: 300 s are waited for another");
  EXPECT_EQ(pool.most(), 1U);
}

TEST(SulPool, DoesNotWaitWithoutEndNorAgainstAStop) {
  for (const bool is_stopped : {false, true}) {
    std::vector<SulPool::Member> members;
    members.push_back(member<MortalSul>("only", 0));
    SulPool pool(std::move(members), {}, std::chrono::milliseconds(is_stopped ? 300'000 : 50));
    std::stop_source stop;
    RunControl control;
    control.stop = stop.get_token();
    const std::jthread stopper([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (is_stopped) stop.request_stop();
    });
    try {
      run(pool, all_words(3), control);
      ADD_FAILURE() << "it ran";
    } catch (const Interrupted&) {
      EXPECT_TRUE(is_stopped);
    } catch (const Error& error) {
      EXPECT_FALSE(is_stopped);
      EXPECT_EQ(error.status(), ExitStatus::system_failed);
      EXPECT_THAT(error.what(), HasSubstr("none has come within 0.05 s; the last one: it died"));
    }
  }
}

std::string refusal(std::unique_ptr<Sul> other) {
  std::vector<SulPool::Member> members;
  members.push_back(member<MortalSul>("first"));
  members.push_back({"second", std::move(other)});
  try {
    const SulPool pool(std::move(members));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(SulPool, MembersMustBeTheSame) {
  EXPECT_THROW(SulPool({}), UsageError);
  EXPECT_EQ(refusal(std::make_unique<MortalSul>()), "");
  EXPECT_THAT(refusal(std::make_unique<SimulatedSul>(test::strict_port(3), "other")),
              HasSubstr("they are 'strict' and 'other' (first, second)"));
  auto newer = std::make_unique<MortalSul>();
  newer->add_version("model", "2");
  EXPECT_THAT(refusal(std::move(newer)), HasSubstr("the version of model is nothing and '2'"));
  EXPECT_THAT(refusal(std::make_unique<SimulatedSul>(test::strict_port(3, true), "strict")),
              HasSubstr("other actors, inputs or outputs"));
}

}  // namespace
}  // namespace maide
