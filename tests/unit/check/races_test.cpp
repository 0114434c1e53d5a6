// Which connections race: systems that do, and systems that only look so.
#include "maide/check/verdict/races.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "maide/check/build/system_file.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Races races_of(const std::string& text, std::uint64_t most_states = 1'000'000) {
  SearchLimits limits;
  limits.states = most_states;
  return find_races(parse_system(text, "s.yaml", test::test_model), limits);
}

// "notice before map, missed at line 8".
std::vector<std::string> told(const std::string& text) {
  const Races races = races_of(text);
  EXPECT_TRUE(races.is_complete);
  EXPECT_FALSE(races.has_unknown);
  std::vector<std::string> lines;
  for (const Race& race : races.all) {
    lines.push_back(race.later + " before " + race.earlier);
    if (race.missed) lines.back() += ", missed at line " + std::to_string(race.missed->line);
  }
  return lines;
}

// A map and a notice of it, with the robot's text.
std::string map_and_notice(const std::string& mapper, const std::string& robot,
                           const std::string& of_map = "") {
  return "topics:\n"
         "  map: {writers: mapper, readers: robot, use: queue, with: {depth: 2}" +
         of_map +
         "}\n"
         "  notice: {writers: mapper, readers: robot, use: queue, with: {depth: 2}}\n"
         "programs:\n"
         "  mapper: \"" +
         mapper +
         "\"\n"
         "  robot: |\n"
         "    " +
         robot + "\n";
}
const char* const write_both = "map.write; notice.write;";
const char* const try_map =
    "notice.read -> message; switch map.tryread { message { skip; } null { skip; } }";

TEST(Races, NoticeThatComesBeforeItsMap) {
  EXPECT_THAT(told(map_and_notice(write_both, try_map)),
              ElementsAre("notice before map, missed at line 7"));
}

TEST(Races, ReaderThatThenWaitsMissesNothing) {
  EXPECT_THAT(told(map_and_notice(write_both, "notice.read -> message; map.read -> message;")),
              ElementsAre("notice before map"));
}

TEST(Races, ReaderThatTakesTheMapFirst) {
  EXPECT_THAT(told(map_and_notice(write_both, "map.read -> message; notice.read -> message;")),
              IsEmpty());
}

TEST(Races, LookBeforeTheNoticeIsNotSuspicious) {
  EXPECT_THAT(told(map_and_notice(write_both,
                                  "switch map.tryread { message { stop; } null { skip; } } "
                                  "notice.read -> message; map.read -> message;")),
              ElementsAre("notice before map"));
}

TEST(Races, WhatIsSentBeforeIsNotOvertakenByIt) {
  EXPECT_THAT(told(map_and_notice("notice.write; map.write;", try_map)), IsEmpty());
}

TEST(Races, WriterThatWaitsForTheArrival) {
  EXPECT_THAT(told(map_and_notice("map.write; wait map -> arrived; notice.write;", try_map)),
              IsEmpty());
}

TEST(Races, MapThatArrivesAtOnce) {
  EXPECT_THAT(told(map_and_notice(write_both, try_map, ", delivery: at_once")), IsEmpty());
}

TEST(Races, ArmsThatFindNothing) {
  EXPECT_THAT(
      told(map_and_notice(write_both,
                          "notice.read -> message; select { on map.read -> message { skip; } "
                          "otherwise { skip; } }")),
      ElementsAre("notice before map, missed at line 7"));
}

// The mapper hears from the robot before it writes the notice.
TEST(Races, WriterThatHearsThatTheMapWasTaken) {
  const std::string text = R"(topics:
  map: {writers: mapper, readers: robot, use: queue, with: {depth: 2}}
  taken: {writers: robot, readers: mapper, use: queue, with: {depth: 2}}
  notice: {writers: mapper, readers: robot, use: queue, with: {depth: 2}}
programs:
  mapper: "map.write; taken.read -> message; notice.write;"
  robot: |
    map.read -> message; taken.write; notice.read -> message;
    switch map.tryread { message { skip; } null { skip; } }
)";
  EXPECT_THAT(told(text), IsEmpty());
}

// What the robot looks for in vain was never written before the notice.
TEST(Races, WritersThatKnowNothingOfEachOther) {
  const std::string text = R"(topics:
  map: {writers: mapper, readers: robot, use: queue, with: {depth: 2}}
  notice: {writers: other, readers: robot, use: queue, with: {depth: 2}}
programs:
  mapper: "map.write;"
  other: "notice.write;"
  robot: |
    notice.read -> message;
    switch map.tryread { message { skip; } null { skip; } }
)";
  EXPECT_THAT(told(text), IsEmpty());
}

// The mapper tells another program, over a topic of that depth, and it tells the robot.
std::string word_that_goes_round(int depth, const std::string& mapper) {
  return fmt::format(R"(topics:
  map: {{writers: mapper, readers: robot, use: queue, with: {{depth: 2}}}}
  told: {{writers: mapper, readers: other, use: queue, with: {{depth: {}}}}}
  notice: {{writers: other, readers: robot, use: queue, with: {{depth: 2}}}}
programs:
  mapper: "{}"
  other: "told.read -> message; notice.write;"
  robot: |
    notice.read -> message;
    switch map.tryread {{ message {{ skip; }} null {{ skip; }} }}
)",
                     depth, mapper);
}

TEST(Races, WordThatGoesRound) {
  EXPECT_THAT(told(word_that_goes_round(2, "map.write; told.write;")),
              ElementsAre("notice before map, missed at line 10"));
}

// The other program has an older message in its queue, and stops behind that.
TEST(Races, OlderMessageTellsNothing) {
  EXPECT_THAT(told(word_that_goes_round(2, "told.write; map.write; told.write;")), IsEmpty());
}

// A topic of depth 1 forgets the older one.
TEST(Races, NewestMessageOfAShortQueueTells) {
  EXPECT_THAT(told(word_that_goes_round(1, "told.write; map.write; told.write;")),
              ElementsAre("notice before map, missed at line 10"));
}

TEST(Races, WordByASharedVariable) {
  const std::string text = R"(topics:
  map: {writers: mapper, readers: robot, use: queue, with: {depth: 2}}
  notice: {writers: other, readers: robot, use: queue, with: {depth: 2}}
variables: "var done: bool;"
programs:
  mapper: "map.write; done = true;"
  other: "select { when (done) { skip; } } notice.write;"
  robot: |
    notice.read -> message;
    switch map.tryread { message { skip; } null { skip; } }
)";
  EXPECT_THAT(told(text), ElementsAre("notice before map, missed at line 10"));
}

TEST(Races, TwoWritersOfOneTopic) {
  const std::string text = R"(topics:
  map: {writers: [first, second], readers: robot, use: queue, with: {depth: 2}}
  told: {writers: first, readers: second, use: queue, with: {depth: 2}}
programs:
  first: "map.write; told.write;"
  second: "told.read -> message; map.write;"
  robot: "map.read -> message; map.read -> message;"
)";
  EXPECT_THAT(told(text), ElementsAre("map before map"));
  EXPECT_THAT(describe_races(races_of(text)).front(), HasSubstr("before what another has sent"));
}

constexpr const char* service = R"(topics:
  map: {writers: server, readers: robot, use: queue, with: {depth: 10}}
services:
  set_map: {server: server, clients: [robot]}
programs:
  server: "loop { idle set_map.serve -> request; map.write; set_map.answer; }"
  robot: |
    set_map.send; set_map.receive -> answer;
    select { on map.read -> message { skip; } otherwise { skip; } }
)";

TEST(Races, AnswerThatComesBeforeTheMap) {
  EXPECT_THAT(told(service), ElementsAre("the answer of set_map before map, missed at line 9"));
  EXPECT_THAT(describe_races(races_of(service)),
              ElementsAre("the answer of set_map may come before map, which robot then looks for "
                          "and does not find (line 9)"));
}

TEST(Races, MapThatIsWrittenBehindTheAnswer) {
  std::string text = service;
  const std::string both = "map.write; set_map.answer;";
  text.replace(text.find(both), both.size(), "set_map.answer; map.write;");
  // What the server writes is no earlier than its answer, and there is no second one.
  EXPECT_THAT(told(text), IsEmpty());
}

// Callbacks of one node: the answer runs before the map's callback.
TEST(Races, CallbacksOfANode) {
  const std::string text = R"(topics:
  go: {writers: operator, readers: robot.on_go, use: queue, with: {depth: 2}}
  map: {writers: server, readers: robot.on_map, use: queue, with: {depth: 2}}
services:
  set_map: {server: server, clients: [robot]}
executors:
  main: {kind: single}
programs:
  operator: "go.write;"
  server: "loop { idle set_map.serve -> request; map.write; set_map.answer; }"
nodes:
  robot:
    executor: main
    clients: {set_map: {do: "skip;"}}
    callbacks:
      on_go: {takes: go.read, do: "set_map.send;"}
      on_map: {takes: map.read, do: "skip;"}
)";
  EXPECT_THAT(told(text), ElementsAre("the answer of set_map before map"));
}

TEST(Races, LimitIsSaid) {
  const Races races = races_of(map_and_notice(write_both, try_map), 5);
  EXPECT_FALSE(races.is_complete);
  EXPECT_THAT(describe_races(races).back(), HasSubstr("there may be more"));
}

TEST(Races, InterruptionEndsTheSearch) {
  std::stop_source source;
  source.request_stop();
  SearchLimits limits;
  limits.control.stop = source.get_token();
  const std::string text = map_and_notice(write_both, try_map);
  EXPECT_FALSE(find_races(parse_system(text, "s.yaml", test::test_model), limits).is_complete);
}

TEST(Races, NothingIsSearchedWhereNothingIsLate) {
  const Races races = races_of(
      "models: {m: {use: mutex}}\nprograms: {a: \"m.lock; m.unlock;\", b: \"m.lock; "
      "m.unlock;\"}\n");
  EXPECT_EQ(races.states, 0);
  EXPECT_THAT(describe_races(races), IsEmpty());
}

TEST(Races, AtMostTenLines) {
  Races races;
  for (int number = 0; number < 12; ++number) {
    races.all.push_back({"b" + std::to_string(number), "a", "r", std::nullopt});
  }
  const std::vector<std::string> lines = describe_races(races);
  EXPECT_EQ(lines.size(), 11);
  EXPECT_EQ(lines.back(), "and 2 more");
}

}  // namespace
}  // namespace maide
