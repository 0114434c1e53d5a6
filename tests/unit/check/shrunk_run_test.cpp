#include "maide/check/search/shrunk_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/report/explanation.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

Property stuck_property() {
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  return property;
}

// The guest's order is answered into a group that its own callback holds. Every answer to the
// regular goes into the guest's queue, too, which holds ten: the states come again after ten
// orders.
System kitchen() {
  return parse_system(R"(services:
  order: {server: cook, clients: [guest, regular]}
executors:
  hall: {kind: multi, threads: 4}
  bar: {kind: multi, threads: 2}
nodes:
  guest:
    executor: hall
    groups: {table: exclusive}
    clients: {order: table}
    callbacks:
      hungry: {timer: 100, group: table, do: "order.send; @asked wait order -> answer;"}
  regular:
    executor: bar
    groups: {seat: exclusive, glass: exclusive}
    clients: {order: seat}
    callbacks:
      thirsty: {timer: 10, group: glass, do: "order.send; wait order -> answer;"}
  cook:
    callbacks:
      serve: {serves: order, do: "order.answer;"}
)",
                      "kitchen.yaml", test::test_model);
}

TEST(ShrunkRun, ItsLoopNeedNotCloseAtOnce) {
  const System system = kitchen();
  const PropertyResult result = NativeEngine().check(system, stuck_property(), {});
  ASSERT_EQ(result.verdict, Verdict::violated);
  const Trace& trace = *result.trace;
  EXPECT_EQ(find_flaw(system, stuck_property(), trace), "");
  EXPECT_LE(trace.steps.size(), 24U);
  const std::string sentence = explain(system, stuck_property(), trace);
  EXPECT_THAT(sentence, HasSubstr("the group table"));
  EXPECT_THAT(sentence, HasSubstr("; the first rounds fill order)"));
  const std::vector<GlobalState> states = replay(system, trace);
  EXPECT_FALSE(models_that_change(trace, states).empty());
  // The same run, told until its states come again, is a counterexample, too.
  const Trace whole = closed(system, trace, states).value();
  EXPECT_GT(whole.steps.size(), 4 * trace.steps.size());
  EXPECT_EQ(find_flaw(system, stuck_property(), whole), "");
  EXPECT_TRUE(models_that_change(whole, replay(system, whole)).empty());
  EXPECT_EQ(shrink(system, stuck_property(), whole, {}).steps.size(), trace.steps.size());
  // It is written and read back.
  const std::string text = to_json_line(trace_file_to_json(system, "stuck", trace));
  EXPECT_EQ(parse_trace(text, "t.json", system).trace, trace);
}

// With room for two, the third write waits: the rounds do not look alike, and cannot go on.
TEST(ShrunkRun, ALoopThatCannotGoOnForEverIsNone) {
  const System system = test::system_of("  p: loop { via.write; }\n  q: sync.read -> message;\n");
  Trace trace;
  GlobalState at = initial_state(system);
  for (int i = 0; i < 2; ++i) {
    const std::vector<Step> steps = enabled_steps(system, at, 0);
    ASSERT_FALSE(steps.empty());
    trace.steps.push_back(steps.front());
    at = apply(system, at, steps.front());
  }
  trace.loop_start = 1;
  EXPECT_EQ(find_flaw(system, stuck_property(), trace), "the loop does not repeat");
}

// Other steps before and in the loop than the violation needs.
class LongRun : public testing::Test {
 protected:
  LongRun() {
    std::vector<std::uint32_t> turns;
    for (int i = 0; i < 30; ++i) turns.insert(turns.end(), {0, 1});
    turns.push_back(2);
    for (int i = 0; i < 6; ++i) turns.insert(turns.end(), {0, 1});
    GlobalState at = initial_state(system_);
    for (const std::uint32_t actor : turns) {
      const Step step = enabled_steps(system_, at, actor).front();
      at = apply(system_, at, step);
      trace_.steps.push_back(step);
    }
    trace_.loop_start = 61;
  }

  System system_ = test::system_of(
      "  a: loop { if * { } else { } }\n"
      "  b: loop { if * { } else { } }\n"
      "  dead: via.read -> message;\n",
      "  served: F dead@end\n");
  Trace trace_;
};

TEST_F(LongRun, LosesWhatTheViolationDoesNotNeed) {
  std::vector<Property> properties{stuck_property(), system_.properties.at(0)};
  for (const Property& property : properties) {
    ASSERT_EQ(find_flaw(system_, property, trace_), "") << property.name;
    const Trace shrunk = shrink(system_, property, trace_, {});
    EXPECT_EQ(find_flaw(system_, property, shrunk), "") << property.name;
    // Dead asks, and a and b go round.
    EXPECT_EQ(shrunk.steps.size(), 3U) << property.name;
    EXPECT_EQ(shrunk, shrink(system_, property, trace_, {})) << property.name;
  }
}

TEST_F(LongRun, IsKeptWhereItMustStop) {
  EXPECT_EQ(shrink(system_, stuck_property(), trace_, {}, 0), trace_);
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  EXPECT_EQ(shrink(system_, stuck_property(), trace_, control), trace_);
}

TEST_F(LongRun, IsACounterexampleHoweverLittleIsTried) {
  for (const std::uint64_t most : {1, 100, 200, 400, 800, 1600, 6400}) {
    const Trace shrunk = shrink(system_, stuck_property(), trace_, {}, most);
    EXPECT_EQ(find_flaw(system_, stuck_property(), shrunk), "") << most;
    EXPECT_LE(shrunk.steps.size(), trace_.steps.size()) << most;
  }
}

}  // namespace
}  // namespace maide
