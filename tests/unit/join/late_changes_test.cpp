// What helps where a message comes too late, or is lost on its way: each change that is suggested,
// and none where the violation needs no late message.
#include "maide/join/late_changes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/join/suggest_change.hpp"

namespace maide {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

std::vector<std::string> suggested(const std::string& text) {
  const System system = parse_system(text, "s.yaml");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  EXPECT_EQ(report.verdict, Verdict::violated);
  return suggest_changes(system, report, {}).changes;
}

const std::string notice = R"(topics:
  map: {writers: mapper, readers: robot, use: queue, with: {depth: 3}}
  notice: {writers: mapper, readers: robot, use: queue, with: {depth: 3}}
programs:
  mapper: "map.write; notice.write;"
  robot: |
    notice.read -> message;
    switch map.tryread { message { @has skip; } null { @missed skip; } }
properties:
  first: "G !robot@missed"
)";

TEST(LateChanges, WaitForTheArrivalAskAgainOrSendOneMessage) {
  EXPECT_THAT(
      suggested(notice),
      ElementsAre(StartsWith("`wait map -> arrived;` behind `map.write;` in line 5 (checked: "),
                  StartsWith("`loop { switch map.tryread { message { @has skip; break; } null { "
                             "skip; } } }` in line 8: ask again (checked: "),
                  StartsWith("map and notice in one message, or on one connection that keeps the "
                             "order: `stream: both` at map and notice (checked: ")));
}

TEST(LateChanges, NoneWhereNothingIsLate) {
  std::string text = notice;
  text.replace(text.find("map.write; notice.write;"), 24, "notice.write; map.write;");
  EXPECT_THAT(suggested(text), Each(Not(HasSubstr("arrived"))));
  for (std::size_t at = 0; (at = text.find("depth: 3}", at)) != std::string::npos; ++at) {
    text.replace(at, 9, "depth: 3}, delivery: at_once");
  }
  EXPECT_THAT(list_late_changes(parse_system(text, "s.yaml")), IsEmpty());
  EXPECT_THAT(find_writer_depths(parse_system(text, "s.yaml")), IsEmpty());
}

TEST(LateChanges, EachWriteWhereOneIsNotEnough) {
  const auto changes = suggested(R"(topics:
  map: {writers: [a, b], readers: robot, use: queue, with: {depth: 5}}
  notice: {writers: [a, b], readers: robot, use: queue, with: {depth: 5}}
programs:
  a: "map.write; notice.write;"
  b: "map.write; notice.write;"
  robot: |
    repeat 2 {
      notice.read -> message;
      select { on map.read -> message { skip; } otherwise { @missed stop; } }
    }
properties:
  first: "G !robot@missed"
)");
  EXPECT_THAT(changes,
              Contains(StartsWith(
                  "`wait map -> arrived;` behind each write to it (lines 5 and 6) (checked: ")));
  EXPECT_THAT(changes, Contains(StartsWith("wait for map in line 10: no `otherwise` (checked: ")));
  EXPECT_THAT(changes, Not(Contains(HasSubstr("behind `map.write;`"))));
}

TEST(LateChanges, WriterThatKeepsMore) {
  EXPECT_THAT(suggested(R"(topics:
  t: {writers: p, readers: q, use: queue, with: {depth: 3, pub-depth: 1}}
programs:
  p: "repeat 3 { t.write; }"
  q: "repeat 3 { t.read -> message; }"
)"),
              Contains(AllOf(StartsWith("t: its writers keep 3 messages in place of 1 (checked: "),
                             HasSubstr("; topics: {t: {with: {pub-depth: 3}}}"))));
}

TEST(LateChanges, WriterKeepsAsManyAsTheTopicUnlessItSaysSo) {
  const std::string text = R"(topics:
  t: {writers: p, readers: q, use: queue, with: {depth: 2}, readers_with: {q: {depth: 3}}}
  kept: {writers: p, readers: q, use: queue, with: {size: 3}, delivery: late}
programs:
  p: "repeat 3 { t.write; }"
  q: "repeat 3 { t.read -> message; }"
)";
  const std::vector<WriterDepth> places = find_writer_depths(parse_system(text, "s.yaml"));
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0].name, "t");
  EXPECT_EQ(places[0].value, 2);
  EXPECT_THAT(suggested(text),
              Contains(StartsWith("t: its writers keep 3 messages in place of 2 (checked: ")));
}

// That it has the answer at last it does not promise: each may come behind its time-out.
TEST(LateChanges, AskTheServerAgain) {
  EXPECT_THAT(
      suggested(R"(services:
  lookup: {server: map, clients: [robot], loses: true, with: {depth: 1}}
programs:
  map: "loop { idle lookup.serve -> request; lookup.answer; }"
  robot: "lookup.send; lookup.receive -> answer; @done skip;"
)"),
      ElementsAre(StartsWith(
          "`loop { select { on lookup.receive -> answer { break; } timeout 100 { "
          "lookup.send; } } }` in place of `lookup.receive -> answer;` in line 5 (checked")));
}

// Labels, values and a name with indices stay as they are written.
TEST(LateChanges, WaitStandsBehindTheWholeStatement) {
  const System system = parse_system(R"(topics:
  map[i in 0..1]: {writers: mapper, readers: robot, use: queue, with: {depth: 2}}
programs:
  mapper: "@first map[1].write(1); map[0].write(0);"
  robot: "map[1].read -> message; map[0].read -> message;"
)",
                                     "s.yaml");
  std::vector<std::string> texts;
  for (const LateChange& change : list_late_changes(system)) texts.push_back(change.text);
  ASSERT_EQ(texts.size(), 3U);
  EXPECT_THAT(texts[0], HasSubstr("\"@first map[1].write(1); wait map[1] -> arrived; map[0].w"));
  EXPECT_THAT(texts[1], HasSubstr("map[0].write(0); wait map[0] -> arrived;\""));
  EXPECT_THAT(texts[2], HasSubstr("map[1] -> arrived; map[0].write(0); wait map[0] -> arrived;"));
}

}  // namespace
}  // namespace maide
