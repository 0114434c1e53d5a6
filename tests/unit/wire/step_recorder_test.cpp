// What the recorder of a step keeps.
#include <gtest/gtest.h>

#include "maide/wire/wrapper/wrapper_session.hpp"

namespace maide {
namespace {

EventTable table(bool tells_gaps) {
  EventTable table;
  table.events = {{"message", {1, true}}, {"next", {1, true}},     {"gap", {1, true}},
                  {"old", {1, true}},     {"written", {0, false}}, {"null", {1, true}}};
  table.message_event = "message";
  table.tells_gaps = tells_gaps;
  return table;
}

std::string names(const std::vector<Event>& events) {
  std::string text;
  for (const Event& event : events) text += event.output + ' ';
  return text;
}

TEST(StepRecorder, TellsWhetherAMessageWasLost) {
  const EventTable events = table(true);
  StepRecorder recorder(events);
  for (const std::uint64_t number : {1U, 2U, 4U, 5U, 5U, 2U, 6U, 9U}) recorder.message(number);
  EXPECT_EQ(names(recorder.take_events()), "next next gap next old old next gap ");
  StepRecorder late(events);
  late.message(2);
  EXPECT_EQ(names(late.take_events()), "gap ");
}

TEST(StepRecorder, WithoutPayloadAMessageIsAMessage) {
  const EventTable events = table(false);
  StepRecorder recorder(events);
  recorder.message(7);
  recorder.message(0);
  EXPECT_EQ(names(recorder.take_events()), "message message ");
  EXPECT_TRUE(recorder.take_events().empty());
}

TEST(StepRecorder, DropsWhatIsNotObservedButTakesItForALifeSign) {
  const EventTable events = table(false);
  StepRecorder recorder(events);
  const auto before = recorder.last_event();
  recorder.report("written");
  EXPECT_TRUE(recorder.take_events().empty());
  EXPECT_GT(recorder.last_event(), before);
}

TEST(StepRecorder, OnceClosedItTakesNothing) {
  const EventTable events = table(false);
  StepRecorder recorder(events);
  recorder.close();
  recorder.report("null");
  recorder.report("undeclared");
  recorder.crashed("late");
  recorder.failed("late");
  EXPECT_TRUE(recorder.take_events().empty());
  EXPECT_EQ(recorder.failure() + recorder.crash_reason(), "");
}

TEST(StepRecorder, KeepsTheFirstReason) {
  const EventTable events = table(false);
  StepRecorder recorder(events);
  recorder.crashed("first");
  recorder.crashed("second");
  recorder.report("undeclared");
  recorder.failed("second");
  EXPECT_EQ(recorder.crash_reason(), "first");
  EXPECT_EQ(recorder.failure(),
            "the wrapper reported event 'undeclared', which it did not declare");
}

}  // namespace
}  // namespace maide
