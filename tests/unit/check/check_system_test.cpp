// What check_system makes of an engine's answers; the engine here is one that breaks.
#include "maide/check/verdict/check_system.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>

#include "maide/check/engines/engine.hpp"
#include "systems.hpp"

namespace maide {
namespace {

// The native engine, but for the properties of some names and for the search for runs beyond what
// was learned, if told so.
class BreakingEngine : public Engine {
 public:
  std::set<std::string> breaks_on;
  bool breaks_on_cut = false;
  bool is_out_of_memory = false;

  std::string name() const override { return "breaking"; }
  std::string obstacle(const System&, const Property&) const override { return ""; }
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override {
    if (breaks_on.contains(property.name)) {
      if (is_out_of_memory) throw std::bad_alloc();
      throw std::logic_error("the search lost a node");
    }
    return native_.check(system, property, options);
  }
  CutResult find_cut(const System& system, const EngineOptions& options) override {
    if (breaks_on_cut) throw std::logic_error("the run to the bound does not replay");
    return native_.find_cut(system, options);
  }

 private:
  NativeEngine native_;
};

// `reads` holds, `writes` is violated, and nothing deadlocks.
System talking() {
  return test::system_of("  p: loop { sync.write; sync.read -> message; }\n",
                         "  reads: G F sync.read\n  writes: G !sync.write\n");
}

CheckReport check(BreakingEngine& engine, const std::vector<std::string>& properties) {
  CheckRequest request;
  request.properties = properties;
  return check_system(talking(), engine, request);
}

// Notes how much time each property has. Of `slow` it takes all, the first time.
class SharingEngine : public Engine {
 public:
  std::vector<std::pair<std::string, double>> shares;  // in seconds
  std::string slow;

  std::string name() const override { return "sharing"; }
  std::string obstacle(const System&, const Property&) const override { return ""; }
  PropertyResult check(const System&, const Property& property,
                       const EngineOptions& options) override {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = options.control.deadline.value();
    shares.emplace_back(property.name, std::chrono::duration<double>(end - Clock::now()).count());
    PropertyResult result;
    result.name = property.name;
    result.verdict = Verdict::holds;
    result.stays_within_learned = true;
    if (property.name != slow) return result;
    slow.clear();
    std::this_thread::sleep_until(end);
    result.verdict = Verdict::inconclusive;
    return result;
  }
  CutResult find_cut(const System&, const EngineOptions&) override { return {}; }
};

TEST(CheckSystem, EachPropertyHasItsShareOfTheTime) {
  SharingEngine engine;
  CheckRequest request;
  request.options.control.deadline = deadline_in(1000);
  check_system(talking(), engine, request);
  ASSERT_EQ(engine.shares.size(), 4U);
  const std::vector<double> expected{250, 333, 500, 1000};  // the first took none
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(engine.shares[i].second, expected[i], 60);
}

TEST(CheckSystem, WhatOthersLeaveGoesToWhatWasNotDecided) {
  SharingEngine engine;
  engine.slow = "deadlock";
  CheckRequest request;
  request.options.control.deadline = deadline_in(2);
  const CheckReport report = check_system(talking(), engine, request);
  ASSERT_EQ(engine.shares.size(), 5U);
  EXPECT_EQ(engine.shares.back().first, "deadlock");
  EXPECT_GT(engine.shares.back().second, engine.shares.front().second);
  EXPECT_EQ(report.properties.front().name, "deadlock");
  EXPECT_EQ(report.verdict, Verdict::holds);
}

TEST(CheckSystem, OneCauseIsShownByOneRun) {
  const System system = test::system_of("  a: via.read -> message;\n  b: skip;\n",
                                        "  done: F a@end\n  asked: G !via.read\n");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  ASSERT_EQ(report.properties.size(), 4U);
  for (const std::size_t i : {0, 2, 3}) {
    ASSERT_TRUE(report.properties[i].trace) << report.properties[i].name;
    EXPECT_EQ(report.properties[i].trace->steps, report.properties[0].trace->steps);
    EXPECT_FALSE(report.properties[i].trace->loop_start);
  }
}

TEST(CheckSystem, AnInternalErrorHidesNoOtherVerdict) {
  BreakingEngine engine;
  engine.breaks_on = {"reads"};
  const CheckReport report = check(engine, {"reads", "writes", "deadlock"});
  ASSERT_EQ(report.properties.size(), 3U);
  EXPECT_EQ(report.properties[0].name, "reads");
  EXPECT_EQ(report.properties[0].verdict, Verdict::inconclusive);
  EXPECT_EQ(report.properties[0].reason,
            "internal error: the search lost a node (please report it)");
  EXPECT_EQ(report.properties[1].verdict, Verdict::violated);
  EXPECT_EQ(report.properties[2].verdict, Verdict::holds);
  EXPECT_EQ(report.verdict, Verdict::violated);
  EXPECT_EQ(exit_status_of(report), ExitStatus::violated);
}

TEST(CheckSystem, AnInternalErrorIsExitStatusFive) {
  BreakingEngine engine;
  engine.breaks_on = {"reads"};
  const CheckReport report = check(engine, {"reads", "deadlock"});
  EXPECT_EQ(report.verdict, Verdict::inconclusive);
  EXPECT_EQ(exit_status_of(report), ExitStatus::internal);
  EXPECT_EQ(static_cast<int>(ExitStatus::internal), 5);
  engine.breaks_on.clear();
  EXPECT_EQ(exit_status_of(check(engine, {"reads", "deadlock"})), ExitStatus::ok);
}

// A "holds" that could not be looked into is none.
TEST(CheckSystem, AnErrorBehindAVerdictUndoesIt) {
  BreakingEngine engine;
  engine.breaks_on_cut = true;
  const CheckReport report = check(engine, {"reads"});
  EXPECT_EQ(report.properties[0].verdict, Verdict::inconclusive);
  EXPECT_TRUE(report.properties[0].is_internal_error);
}

TEST(CheckSystem, MemoryThatIsOutIsNoInternalError) {
  BreakingEngine engine;
  engine.breaks_on = {"reads"};
  engine.is_out_of_memory = true;
  EXPECT_THROW(check(engine, {"reads"}), std::bad_alloc);
}

// The lines that a check of everything rests on.
std::vector<std::string> assumptions_of(const std::string& text) {
  NativeEngine engine;
  return check_system(parse_system(text, "system.yaml", test::test_model), engine).assumptions;
}

TEST(CheckSystem, NamesModelsThatAreWrittenByHandAndSharedVariables) {
  EXPECT_EQ(assumptions_of("models:\n  'm[i in 0..1]': {use: mutex}\n"
                           "  s: {use: semaphore, with: {count: 3}}\n"
                           "  q: {use: queue, with: {size: 2}}\n"
                           "  d: {use: queue, with: {depth: 4}}\n"
                           "  via: {file: strict-2.dot}\n  unused: {use: mutex}\n"
                           "variables: \"var n: 0..2;\"\nprograms:\n"
                           "  'p[i in 0..1]': |\n"
                           "    m[i].lock; s.acquire; q.write; d.write; n = i; via.write;\n"),
            (std::vector<std::string>{
                "via: strength unknown, for the model does not say how it was tested",
                "d is written by hand (a queue of depth 4)",
                "m[0], m[1] are written by hand (a mutex each)", "n is a shared variable",
                "q is written by hand (a queue of size 2)",
                "s is written by hand (a semaphore of count 3)"}));
}

TEST(CheckSystem, AVerdictThatHoldsRestsOnTimeOuts) {
  const std::string system =
      "models:\n  q: {use: queue, with: {size: 1}}\nprograms:\n  p: |\n"
      "    select {\n      on q.read -> message { }\n      timeout 10 { }\n    }\n";
  const auto lines = assumptions_of(system);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& text) {
    return text.starts_with("time is not modelled: the time-out at line ") &&
           text.ends_with(" may come as soon as nothing else can");
  })) << testing::PrintToString(lines);
  const auto without =
      assumptions_of("models:\n  q: {use: queue, with: {size: 1}}\nprograms:\n  p: q.write;\n");
  EXPECT_EQ(without, std::vector<std::string>{"q is written by hand (a queue of size 1)"});
}

// A receiver that listens with a time-out, and what is remarked of it. The models are `q`, a queue,
// and `via`, which was learned for two messages.
std::vector<std::string> remarks_of(const std::string& receiver, const std::string& others,
                                    const std::string& when_unexplored = "stop") {
  NativeEngine engine;
  return check_system(parse_system("models:\n  q: {use: queue, with: {size: 1}}\n"
                                   "  via: {file: strict-2.dot, when_unexplored: " +
                                       when_unexplored + "}\nprograms:\n  receiver: |\n    " +
                                       receiver + "\n" + others,
                                   "system.yaml", test::test_model),
                      engine)
      .remarks;
}

TEST(CheckSystem, RemarksWhomOnlyATimeOutWakes) {
  const std::string listens = "loop { select { on q.read -> message { } timeout 10 { } } }";
  const std::vector<std::string> woken{
      "only its time-out wakes receiver from some point on: it waits at line 6 in a select for "
      "q.read -> message, and nothing of that can come again"};
  EXPECT_EQ(remarks_of(listens, "  sender: q.write;\n"), woken);
  EXPECT_EQ(remarks_of(listens, "  sender: {do: \"loop { q.write; }\", may_die: true}\n"), woken);
  EXPECT_EQ(remarks_of("select { on q.read -> message { } timeout 10 { } }",
                       "  sender: \"if * { q.write; }\"\n"),
            woken);
  // It may come again, a pause waits for nothing, and who is idle may wait in vain.
  const std::vector<std::string> none;
  EXPECT_EQ(remarks_of(listens, "  sender: \"loop { if * { q.write; } }\"\n"), none);
  EXPECT_EQ(remarks_of("loop { select { timeout 10 { } } }", "  sender: q.write;\n"), none);
  EXPECT_EQ(remarks_of("loop { idle select { on q.read -> message { } timeout 10 { } } }",
                       "  sender: q.write;\n"),
            none);
}

// Who makes come what it waits for, once it was woken, does not wait in vain.
TEST(CheckSystem, ATimeOutThatIsFollowedByARetryIsNotRemarked) {
  EXPECT_EQ(remarks_of("loop { select { on q.read -> message { } timeout 10 { q.write; } } }",
                       "  other: skip;\n"),
            std::vector<std::string>{});
}

// Nobody knows what comes beyond what was learned.
TEST(CheckSystem, BeyondWhatWasLearnedAnythingMayWake) {
  const std::string listens = "loop { select { on q.read -> message { } timeout 10 { } } }";
  const std::string sender = "  sender: \"repeat 3 { via.write; } q.write;\"\n";
  EXPECT_EQ(remarks_of(listens, sender, "stop"), std::vector<std::string>{});
  EXPECT_EQ(remarks_of(listens, sender, "wait").size(), 1U);
}

// A formula is false at the only position that a run has which begins at an error.
TEST(CheckSystem, TheFirstPositionCountsWhereARunBeginsAtAnError) {
  const System system = parse_system(
      "models:\n  q: {use: queue, with: {size: 1}}\nprograms:\n"
      "  p1: |\n    var x: 0..1; x = 1 / x; q.write;\n  p2: q.write;\n"
      "properties:\n  at_once: {ltl: p2@end, fairness: none}\n"
      "  always: {always: p2@end}\n  soon: F p2@end\n  never: G !p2@end\n",
      "system.yaml", test::test_model);
  NativeEngine engine;
  const CheckReport report =
      check_system(system, engine, {{"at_once", "always", "soon", "never"}, {}});
  ASSERT_EQ(report.properties.size(), 5U);
  EXPECT_EQ(report.properties[0].verdict, Verdict::violated);
  EXPECT_TRUE(report.properties[0].trace.value().steps.empty());
  EXPECT_EQ(report.properties[1].verdict, Verdict::violated);
  EXPECT_EQ(report.properties[2].verdict, Verdict::inconclusive);
  EXPECT_EQ(report.properties[3].verdict, Verdict::inconclusive);
  EXPECT_EQ(report.properties[4].name, "error");
  EXPECT_EQ(report.properties[4].verdict, Verdict::violated);
}

// For a formula the run is cut before its step into an error, whatever that step gives.
TEST(CheckSystem, AStepIntoAnErrorIsNoPosition) {
  const System system = parse_system(
      "models:\n  m: {use: mutex}\nprograms:\n"
      "  p: |\n    var x: 0..2; m.lock; m.unlock; x = 1; m.lock; x = x + 2;\n"
      "properties:\n  few: {ltl: G (m.lock -> p.x == 0)}\n  small: {always: p.x < 2}\n"
      "  unlocked: G !m.unlock\n",
      "system.yaml", test::test_model);
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {{"few", "small", "unlocked"}, {}});
  ASSERT_EQ(report.properties.size(), 4U);
  EXPECT_EQ(report.properties[0].verdict, Verdict::inconclusive);  // x is 1 at the second lock
  EXPECT_EQ(report.properties[1].verdict, Verdict::inconclusive);
  EXPECT_EQ(report.properties[2].verdict, Verdict::violated);
  EXPECT_EQ(report.properties[3].name, "error");
  EXPECT_EQ(report.properties[3].verdict, Verdict::violated);
}

}  // namespace
}  // namespace maide
