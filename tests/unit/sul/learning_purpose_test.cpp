#include "maide/sul/learning_purpose.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"

namespace maide {
namespace {

const std::vector<std::string> sends{"write"};
const std::vector<std::string> receives{"next", "gap"};

TEST(LearningPurpose, BoundsMessagesInFlight) {
  const auto purpose = LearningPurpose::in_flight(2, 0, sends, receives, AtBound::refuse);
  LearningPurpose::Monitor monitor(purpose);
  EXPECT_TRUE(monitor.allows("write"));
  monitor.on_input("write");
  monitor.on_input("write");
  EXPECT_FALSE(monitor.allows("write"));
  EXPECT_TRUE(monitor.allows("read"));  // not of its alphabet
  monitor.on_output("gap");
  EXPECT_TRUE(monitor.allows("write"));
  monitor.on_output("next");
  monitor.on_output("next");  // below zero it stays at zero
  monitor.on_input("write");
  EXPECT_TRUE(monitor.allows("write"));
}

TEST(LearningPurpose, NeverBindsWhereTheSystemItselfKeepsFewer) {
  const auto purpose = LearningPurpose::in_flight(3, 1, sends, receives, AtBound::refuse);
  LearningPurpose::Monitor monitor(purpose);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(monitor.allows("write"));
    monitor.on_input("write");
  }
}

TEST(LearningPurpose, BindsBelowTheCapacity) {
  const auto purpose = LearningPurpose::in_flight(2, 10, sends, receives, AtBound::absorb);
  EXPECT_EQ(purpose.at_bound(), AtBound::absorb);
  LearningPurpose::Monitor monitor(purpose);
  monitor.on_input("write");
  monitor.on_input("write");
  EXPECT_FALSE(monitor.allows("write"));
}

TEST(LearningPurpose, MustBeDeterministic) {
  InterfaceAutomaton automaton({"write"}, {}, 2);
  automaton.add_transition(0, {Action::Kind::input, 0}, 0);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  EXPECT_THROW(LearningPurpose{automaton}, UsageError);
}

}  // namespace
}  // namespace maide
