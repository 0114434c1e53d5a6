// Calls that return when all readers have the message (`delivery: acknowledged`), and answers that
// do so. Random systems are held against an interpreter with wires of its own in tests/referee.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/system/steps.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/report/trace_text.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::Contains;
using testing::HasSubstr;

System calling(const std::string& text) { return parse_system(text, "s.yaml", test::test_model); }

CheckReport report_of(const System& system, Reduction reduction) {
  NativeEngine engine;
  CheckRequest request;
  request.options.reduction = reduction;
  return check_system(system, engine, request);
}

// By property, the verdict that all reductions agree on.
std::map<std::string, std::string> verdicts(const std::string& text) {
  const System system = calling(text);
  std::map<std::string, std::string> common;
  for (const Reduction reduction :
       {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
    for (const PropertyResult& result : report_of(system, reduction).properties) {
      std::string& verdict = common[result.name];
      const std::string found = to_string(result.verdict);
      if (!verdict.empty() && verdict != found) verdict += ", and ";
      if (verdict != found) verdict += found;
    }
  }
  return common;
}

std::string with(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

// A chart for two, then a bell for one of them, who tells the other.
const std::string chart_for_two =
    "topics:\n"
    "  chart: {writers: desk, readers: [pilot, clerk], use: queue, with: {depth: 2}, delivery: "
    "acknowledged}\n"
    "  bell: {writers: desk, readers: pilot, use: queue, with: {depth: 1}}\n"
    "  word: {writers: pilot, readers: clerk, use: queue, with: {depth: 1}}\n"
    "programs:\n"
    "  desk: \"chart.write; @told bell.write;\"\n"
    "  pilot: |\n"
    "    bell.read -> message;\n"
    "    switch chart.tryread { message { } null { @blind skip; } }\n"
    "    word.write;\n"
    "  clerk: |\n"
    "    word.read -> message;\n"
    "    switch chart.tryread { message { } null { @blind skip; } }\n"
    "properties:\n"
    "  pilot: \"G !pilot@blind\"\n"
    "  clerk: \"G !clerk@blind\"\n";

TEST(Acknowledged, ACallReturnsWhenAllHaveTheMessage) {
  const auto found = verdicts(chart_for_two);
  EXPECT_EQ(found.at("pilot"), "holds");
  EXPECT_EQ(found.at("clerk"), "holds");
  EXPECT_EQ(found.at("deadlock"), "holds");
  EXPECT_EQ(found.at("stuck"), "holds");
  const auto late = verdicts(with(chart_for_two, "acknowledged", "late"));
  EXPECT_EQ(late.at("pilot"), "violated");
  EXPECT_EQ(late.at("clerk"), "violated");
}

// The one who has it tells the other, who does not have it yet.
const std::string first_tells_second =
    "topics:\n"
    "  chart: {writers: desk, readers: [pilot, clerk], use: queue, with: {depth: 1}, delivery: "
    "acknowledged}\n"
    "  word: {writers: pilot, readers: clerk, use: queue, with: {depth: 1}, delivery: at_once}\n"
    "programs:\n"
    "  desk: \"chart.write; @told loop { idle chart.write; }\"\n"
    "  pilot: \"chart.read -> message; @has word.write;\"\n"
    "  clerk: |\n"
    "    word.read -> message;\n"
    "    switch chart.tryread { message { @has skip; loop { idle word.read -> message; } }\n"
    "                           null { @blind skip; } }\n"
    "properties:\n"
    "  there: \"G !clerk@blind\"\n"
    "  waits: {always: \"!(chart!null && desk@told)\"}\n";

TEST(Acknowledged, OneReaderMayHaveItBeforeTheOther) {
  EXPECT_EQ(verdicts(first_tells_second).at("there"), "violated");
  const std::string at_once = with(first_tells_second, "acknowledged", "at_once");
  EXPECT_EQ(verdicts(at_once).at("there"), "holds");
}

TEST(Acknowledged, ItStandsInTheCallMeanwhile) {
  EXPECT_EQ(verdicts(first_tells_second).at("waits"), "holds");
  const std::string late = with(first_tells_second, "acknowledged", "late");
  EXPECT_EQ(verdicts(late).at("waits"), "violated");
}

// When both have read, the call has returned: nothing lies between.
TEST(Acknowledged, TheLastArrivalAndTheReturnAreOneStep) {
  const std::string text =
      "topics: {chart: {writers: desk, readers: [pilot, clerk], use: queue, with: {depth: 1}, "
      "delivery: acknowledged}}\n"
      "programs:\n"
      "  desk: \"chart.write; @told chart.write;\"\n"
      "  pilot: \"chart.read -> message; @has idle chart.read -> message;\"\n"
      "  clerk: \"chart.read -> message; @has idle chart.read -> message;\"\n"
      "properties:\n"
      "  early: {always: \"!(pilot@has && clerk@has && !desk@told && !desk@end)\"}\n"
      "  step: {ltl: \"chart[pilot]!arrives R !(chart[clerk]!arrives && desk@told)\", fairness: "
      "none}\n"
      "  told: {possible: \"chart[clerk]!arrives && desk@told\"}\n";
  const auto found = verdicts(text);
  EXPECT_EQ(found.at("step"), "holds");
  EXPECT_EQ(found.at("told"), "holds");
  // In the second call both have what the first one brought.
  EXPECT_EQ(found.at("early"), "violated");
  const std::string once = with(text, "@told chart.write;", "@told skip;");
  EXPECT_EQ(verdicts(once).at("early"), "holds");
}

TEST(Acknowledged, WithOneReaderNothingIsOnItsWay) {
  const System system = calling(
      "topics: {chart: {writers: desk, readers: pilot, use: queue, with: {depth: 1}, "
      "delivery: acknowledged}}\n"
      "programs: {desk: \"chart.write;\", pilot: \"chart.read -> message;\"}\n");
  EXPECT_TRUE(system.nobodys_actions.empty());
  EXPECT_EQ(system.models.size(), 1U);
}

TEST(Acknowledged, ALossEndsACallToo) {
  const std::string text = with(chart_for_two, "acknowledged}", "acknowledged, loses: true}");
  const auto found = verdicts(text);
  EXPECT_EQ(found.at("pilot"), "violated");
  EXPECT_EQ(found.at("deadlock"), "holds");
  EXPECT_EQ(found.at("stuck"), "holds");
}

TEST(Acknowledged, TheDeathOfReadersEndsACall) {
  const std::string text =
      "topics: {chart: {writers: desk, readers: [pilot, clerk], use: queue, with: {size: 1}, "
      "delivery: acknowledged}}\n"
      "programs:\n"
      "  desk: \"chart.write; chart.write; @told skip;\"\n"
      "  pilot: {do: \"chart.read -> message; stop;\", may_die: true}\n"
      "  clerk: {do: \"loop { idle chart.read -> message; }\", may_die: true}\n"
      "properties:\n"
      "  dies: \"F (pilot@end && clerk@end) -> F desk@told\"\n"
      "  full: {ltl: \"F desk@told\", fairness: strong}\n";
  const auto found = verdicts(text);
  EXPECT_EQ(found.at("dies"), "holds");
  EXPECT_EQ(found.at("full"), "holds");
}

TEST(Acknowledged, ADeadWritersMessageArrivesAtSome) {
  const std::string text =
      "topics: {chart: {writers: desk, readers: [pilot, clerk], use: queue, with: {depth: 1}, "
      "delivery: acknowledged}}\n"
      "programs:\n"
      "  desk: {do: \"chart.write; @told skip;\", may_die: true}\n"
      "  pilot: \"idle chart.read -> message; @has skip;\"\n"
      "  clerk: \"idle chart.read -> message; @has skip;\"\n"
      "properties:\n"
      "  both: {possible: \"pilot@has && clerk@has && desk@end && !desk@told\"}\n"
      "  one: \"F (pilot@has <-> clerk@has)\"\n"
      "  only: \"G !(F G pilot@has && G !clerk@has)\"\n";
  const auto found = verdicts(text);
  EXPECT_EQ(found.at("both"), "holds");
  EXPECT_EQ(found.at("only"), "violated");
}

TEST(Acknowledged, IsNoArm) {
  const std::string text =
      with(chart_for_two, "chart.write; @told bell", "select { on chart.write { } } @told bell");
  EXPECT_THAT(test::error_of([&] { calling(text); }),
              HasSubstr("no arm can be 'chart.write': it returns when all readers have the message "
                        "(delivery: acknowledged) (s.yaml:6:"));
  EXPECT_NO_THROW(calling(with(text, "acknowledged", "late")));
}

// Two threads of one node stand in calls of their own.
TEST(Acknowledged, ThreadsOfANodeCallByThemselves) {
  const std::string text =
      "topics:\n"
      "  go: {writers: [desk, clerk], readers: [hall.one, hall.two], use: queue, with: {depth: 2}, "
      "delivery: at_once}\n"
      "  chart: {writers: hall, readers: [desk, clerk], use: queue, with: {depth: 2}, delivery: "
      "acknowledged}\n"
      "executors: {main: {kind: multi, threads: 2}}\n"
      "nodes:\n"
      "  hall:\n"
      "    executor: main\n"
      "    groups: {free: reentrant}\n"
      "    callbacks:\n"
      "      one: {takes: \"go.read -> message\", group: free, do: \"@calls chart.write; @first "
      "skip;\"}\n"
      "      two: {takes: \"go.read -> message\", group: free, do: \"@calls chart.write; @second "
      "skip;\"}\n"
      "programs:\n"
      "  desk: \"go.write; repeat 2 { chart.read -> message; } @has skip;\"\n"
      "  clerk: \"repeat 2 { chart.read -> message; } @has skip;\"\n"
      "properties:\n"
      "  all: \"F (desk@has && clerk@has)\"\n";
  const auto found = verdicts(text);
  EXPECT_EQ(found.at("all"), "holds");
  EXPECT_EQ(found.at("deadlock"), "holds");
}

// ---- answers ------------------------------------------------------------------------------------

const std::string answer_for_two =
    "topics: {note: {writers: server, readers: second, use: queue, with: {depth: 1}, delivery: "
    "at_once}}\n"
    "services: {ask: {server: server, clients: [first, second], delivery: acknowledged}}\n"
    "programs:\n"
    "  server: \"ask.serve -> request; ask.answer; @told note.write;\"\n"
    "  first: \"idle ask.receive -> answer; @has skip;\"\n"
    "  second: |\n"
    "    ask.send; note.read -> message;\n"
    "    select { on ask.receive -> answer { } otherwise { @blind skip; } }\n"
    "properties:\n"
    "  there: \"G !second@blind\"\n";

TEST(Acknowledged, AnAnswerReturnsWhenAllClientsHaveIt) {
  EXPECT_EQ(verdicts(answer_for_two).at("there"), "holds");
  EXPECT_EQ(verdicts(answer_for_two).at("deadlock"), "holds");
  const std::string late = with(answer_for_two, "acknowledged", "late");
  EXPECT_EQ(verdicts(late).at("there"), "violated");
  const System one = calling(
      with(with(answer_for_two, "[first, second]", "second"), "idle ask.receive -> answer; ", ""));
  EXPECT_TRUE(one.nobodys_actions.empty());
}

TEST(Acknowledged, AnAnswerIsNoArmThen) {
  const std::string text =
      with(answer_for_two, "ask.answer; @told", "select { on ask.answer { } } @told");
  EXPECT_THAT(
      test::error_of([&] { calling(text); }),
      HasSubstr("no arm can be 'ask.answer': it returns when all readers have the message"));
}

// ---- what others see of it ----------------------------------------------------------------------

TEST(Acknowledged, AssumptionsSayIt) {
  const CheckReport report = report_of(calling(chart_for_two), Reduction::none);
  EXPECT_THAT(report.assumptions,
              Contains(HasSubstr("chart: a call returns when all readers have what it sent")));
  EXPECT_THAT(report.assumptions,
              Contains(HasSubstr("chart, bell, word: what is sent arrives some time later")));
}

// A step of the writer's automaton, which nobody does.
TEST(Acknowledged, WhatEndsACallIsDoneByNobody) {
  const System system = calling(first_tells_second);
  Trace trace;
  GlobalState state = initial_state(system);
  const auto take = [&](const std::string& text) {
    for (const Step& step : enabled_steps(system, state)) {
      if (describe_step(system, step).event != text) continue;
      state = apply(system, state, step);
      trace.steps.push_back(step);
      return;
    }
    FAIL() << text;
  };
  take("chart.write");
  take("chart[clerk]!arrives");
  EXPECT_EQ(trace.steps.back().actor, nobody);
  take("chart[pilot]!arrives");
  EXPECT_NE(trace.steps.back().actor, nobody);
  EXPECT_EQ(doer_of(system, trace.steps.back()), nobody);
  std::ostringstream out;
  write_trace_text(out, system, trace, TraceFormat::steps, {});
  EXPECT_THAT(out.str(), HasSubstr("3  -  "));
  const Json steps = trace_to_json(system, trace);
  EXPECT_TRUE(steps[2]["program"].is_null());
  // Formulas know no program that did it.
  const std::string text = with(first_tells_second, "  there: \"G !clerk@blind\"",
                                "  its: \"G !desk:chart[pilot]!arrives\"\n"
                                "  any: \"G !chart[pilot]!arrives\"");
  EXPECT_EQ(verdicts(text).at("its"), "holds");
  EXPECT_EQ(verdicts(text).at("any"), "violated");
}

}  // namespace
}  // namespace maide
