// How wrappers died.
#include <gtest/gtest.h>

#include "maide/wire/client/wrapper_connection.hpp"

namespace maide {
namespace {

using Verdict = DeathRecord::Verdict;

// A death behind steps with these outputs.
Death death_after(const std::vector<std::string>& outputs, WordEnd end = WordEnd::crash) {
  Death death{end, "gone", std::vector<SulStep>(), false};
  for (const std::string& output : outputs) {
    SulStep& step = death.before->emplace_back();
    step.events = {{0, output}};
    step.duration = std::chrono::microseconds(death.before->size() * 17);
  }
  return death;
}

Death death_somewhere() { return {WordEnd::crash, "gone", {}, false}; }

TEST(DeathRecord, TwoMoreAtOnePlaceMakeACrash) {
  DeathRecord record;
  EXPECT_EQ(record.add(death_somewhere()), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"a"})), Verdict::ask_again);
  Death again = death_after({"a"});
  again.before->front().duration = {};  // no two runs take the same time
  EXPECT_EQ(record.add(again), Verdict::reproducible);
  EXPECT_EQ(record.count(), 3U);
}

TEST(DeathRecord, WhatTheWrapperSaysOfItsFirstDeathIsNoProofYet) {
  DeathRecord record;
  EXPECT_EQ(record.add(death_after({"a"})), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"a"})), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"a"})), Verdict::reproducible);
}

TEST(DeathRecord, AHangNeedsToComeOnceMoreOnly) {
  DeathRecord record;
  EXPECT_EQ(record.add(death_after({}, WordEnd::hang)), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({}, WordEnd::hang)), Verdict::reproducible);
}

TEST(DeathRecord, OtherAnswersBeforeItAreAnotherPlace) {
  DeathRecord record;
  EXPECT_EQ(record.add(death_somewhere()), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"a"})), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"b"})), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"a"}, WordEnd::hang)), Verdict::ask_again);
  EXPECT_EQ(record.add(death_after({"b"})), Verdict::reproducible);
}

TEST(DeathRecord, DeathsHereAndThereAreHopeless) {
  DeathRecord record;
  std::vector<std::string> outputs;
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(record.add(death_after(outputs)), Verdict::ask_again);
    outputs.emplace_back("a");
  }
  EXPECT_EQ(record.add(death_after(outputs)), Verdict::hopeless);
}

TEST(DeathRecord, DeathsNobodyKnowsWhereProveNothing) {
  DeathRecord record;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(record.add(death_somewhere()), Verdict::ask_again);
  EXPECT_EQ(record.add(death_somewhere()), Verdict::hopeless);
}

}  // namespace
}  // namespace maide
