// The engine: verdicts, traces and counts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "mailbox_ranks.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

EngineOptions reduced() {
  EngineOptions options;
  options.reduction = Reduction::full;
  return options;
}

// With all reductions unless told otherwise.
PropertyResult check(const System& system, const Property& property,
                     const EngineOptions& options = reduced()) {
  return NativeEngine().check(system, property, options);
}

Property stuck() {
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  return property;
}

TEST(NativeEngine, FindsAShortestDeadlock) {
  const System system = test::system_of("  p: loop { via.write; sync.read -> message; }\n");
  const PropertyResult result = check(system, test::deadlock_property());
  EXPECT_EQ(result.verdict, Verdict::violated);
  ASSERT_TRUE(result.trace);
  EXPECT_EQ(result.trace->steps.size(), 2u);
}

TEST(NativeEngine, ProgramsThatEndAreNoDeadlock) {
  const PropertyResult result =
      check(test::system_of("  p: via.write;\n"), test::deadlock_property());
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_EQ(result.states, 2u);
}

// The planner goes on for ever; the controller waits for a message that nobody sends.
TEST(NativeEngine, AProgramIsStuckWhileAnotherRunsOn) {
  const System system = test::system_of(
      "  planner: loop { sync.write; sync.read -> message; }\n"
      "  controller: via.read -> message;\n");
  EXPECT_EQ(check(system, test::deadlock_property()).verdict, Verdict::holds);
  const PropertyResult result = check(system, stuck());
  ASSERT_EQ(result.verdict, Verdict::violated);
  EXPECT_TRUE(result.trace->loop_start);
  EXPECT_EQ(find_flaw(system, stuck(), *result.trace), "");
}

// The search meets the long way round first.
TEST(NativeEngine, ShowsAShortFairRun) {
  const System system = test::system_of(
      "  watchdog: loop { if * { repeat 40 { if * { } else { } } } else { } }\n"
      "  dead: via.read -> message;\n",
      "  served: F dead@end\n"
      "  strongly: {ltl: F dead@end, fairness: strong}\n"
      "  never_waits: \"G !watchdog@end && !X X X true\"\n");
  std::vector<Property> properties{stuck()};
  properties.insert(properties.end(), system.properties.begin(), system.properties.end());
  for (const Property& property : properties) {
    const PropertyResult result = check(system, property);
    ASSERT_EQ(result.verdict, Verdict::violated) << property.name;
    EXPECT_EQ(find_flaw(system, property, *result.trace), "") << property.name;
    if (property.name == "never_waits") continue;
    // Dead asks, and the watchdog goes the short way round.
    EXPECT_EQ(result.trace->steps.size(), 2u) << property.name;
    EXPECT_EQ(result.trace->loop_start, 1u) << property.name;
  }
}

// Each program has to step on the cycle: two each, and one before it.
TEST(NativeEngine, AShortRunIsFairToAll) {
  const System system = test::system_of(
      "  a: loop { if * { repeat 20 { if * { } else { } } } else { } }\n"
      "  b: loop { if * { } else { repeat 20 { if * { } else { } } } }\n"
      "  c: loop { if * { repeat 20 { if * { } else { } } } else { } }\n"
      "  dead: via.read -> message;\n");
  const PropertyResult result = check(system, stuck());
  ASSERT_EQ(result.verdict, Verdict::violated);
  EXPECT_EQ(find_flaw(system, stuck(), *result.trace), "");
  EXPECT_EQ(result.trace->steps.size(), 4u);
  EXPECT_EQ(result.trace->loop_start, 1u);
}

TEST(NativeEngine, AProgramThatHasEndedIsNotStuck) {
  const System system = test::system_of(
      "  planner: loop { sync.write; sync.read -> message; }\n"
      "  controller: via.write;\n");
  EXPECT_EQ(check(system, stuck()).verdict, Verdict::holds);
}

// `guest` can take the message again and again, and never all the time.
TEST(NativeEngine, TheFairerTheRunsTheMoreHolds) {
  const System system = test::system_of(
      "  busy: loop { sync.write; sync.read -> message; }\n"
      "  guest: wait sync -> message;\n",
      "  served: F guest@end\n");
  const auto verdict = [&](Fairness fairness) {
    Property property = system.properties.front();
    property.fairness = fairness;
    return check(system, property).verdict;
  };
  EXPECT_EQ(verdict(Fairness::none), Verdict::violated);
  EXPECT_EQ(verdict(Fairness::weak), Verdict::violated);
  EXPECT_EQ(verdict(Fairness::strong), Verdict::holds);
}

TEST(NativeEngine, ChecksNext) {
  const System system = test::system_of("  p: '@a via.write; @b via.write; @c via.write;'\n",
                                        "  right: {ltl: 'p@a && X p@b && X X p@c'}\n"
                                        "  wrong: {ltl: 'X X p@b'}\n"
                                        "  event: {ltl: 'X via.write && X X via.write'}\n"
                                        "  after: {ltl: 'F G !via.write'}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::violated);
  EXPECT_EQ(check(system, system.properties[2]).verdict, Verdict::holds);
}

// A run that was cut is a counterexample only if it is one whatever comes.
TEST(NativeEngine, ARunThatIsCutProvesNothingMore) {
  const System system =
      test::system_of("  p: repeat 3 { via.write; }\n",
                      "  ends: {ltl: F p@end}\n  never: {ltl: G !via.write, fairness: none}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::violated);
  const CutResult cut = NativeEngine().find_cut(system, {});
  ASSERT_EQ(cut.verdict, Verdict::violated);
  EXPECT_EQ(cut.trace->steps.size(), 3u);
}

// Fairness is a bit for each program: beyond a word of them there is no verdict, and no wrong one.
// A ring in which one token goes round, and `spin`, which runs for ever: one component of that many
// programs. `last` is the body of the last station, which has read the token.
System ring_of(int programs, const std::string& last, const std::string& properties) {
  const std::string end = std::to_string(programs - 2), before = std::to_string(programs - 3);
  return parse_system(
      "models:\n  box[i in 0.." + end + "]: {use: queue, with: {size: 1}}\n" +
          "  own: {use: queue, with: {size: 1}}\n" + "variables: \"var n: 0..1;\"\nprograms:\n" +
          "  first: \"box[0].write; loop { box[" + end +
          "].read -> message; if (n == 1) { } box[0].write; }\"\n" + "  s[i in 1.." + before +
          "]: \"loop { box[i - 1].read -> message; @has box[i].write; }\"\n" +
          "  last: \"loop { box[" + before + "].read -> message; @has " + last + " box[" + end +
          "].write; }\"\n" + "  spin: \"loop { n = 1 - n; }\"\n" + "properties:\n" + properties,
      "ring.yaml");
}

// Programs and marks are bits of one word, and of several beyond 64 programs. The verdicts do not
// depend on it.
TEST(NativeEngine, MoreProgramsThanBitsOfAWord) {
  const std::string formulas =
      "  comes: {ltl: \"G F s[2]@has\", fairness: weak}\n"
      "  stays: {ltl: \"F G !s[2]@has\", fairness: strong}\n"
      "  leaves: {ltl: \"F G !s[2]@has\", fairness: weak}\n"
      "  none: {ltl: \"G F s[2]@has\", fairness: none}\n";
  const std::vector<Verdict> expected{Verdict::holds, Verdict::violated, Verdict::violated,
                                      Verdict::violated};
  const std::vector<Verdict> if_kept{Verdict::violated, Verdict::holds, Verdict::holds,
                                     Verdict::violated};
  for (const int programs : {6, 64, 65, 90}) {
    SCOPED_TRACE(programs);
    const System ring = ring_of(programs, "", formulas);
    ASSERT_EQ(ring.programs.size(), static_cast<std::size_t>(programs));
    EXPECT_EQ(check(ring, stuck()).verdict, Verdict::holds);
    // The last station keeps the token, and all others but `spin` wait for ever.
    const System kept = ring_of(programs, "loop { own.write; own.read -> message; }", formulas);
    EXPECT_EQ(check(kept, stuck()).verdict, Verdict::violated);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(check(ring, ring.properties[i]).verdict, expected[i]) << ring.properties[i].name;
      EXPECT_EQ(check(kept, kept.properties[i]).verdict, if_kept[i]) << ring.properties[i].name;
    }
  }
}

// 600 programs in turn: nineteen words a state, and few states. Where one does not hand the turn
// on, all others are stuck.
TEST(NativeEngine, StatesOfManyWords) {
  const auto in_turn = [](const std::string& who_hands_on) {
    std::string text = "constants: {last: 599}\nvariables: \"var turn: 0..600;\"\nprograms:\n";
    text += "  p[i in 0..last]: \"select { when (turn == i) { } } if (" + who_hands_on +
            ") { atomic { turn = i + 1; } }\"\n"
            "properties:\n  all_end: \"F p[last]@end\"\n";
    return parse_system(text, "s.yaml");
  };
  const System system = in_turn("i >= 0");
  const PropertyResult ends = check(system, test::deadlock_property(), {});
  EXPECT_EQ(ends.verdict, Verdict::holds);
  EXPECT_EQ(ends.states, 1201U);
  const System kept = in_turn("i != 40");
  const PropertyResult deadlock = check(kept, test::deadlock_property(), {});
  ASSERT_EQ(deadlock.verdict, Verdict::violated);
  EXPECT_EQ(deadlock.trace->steps.size(), 81U);
  EXPECT_EQ(find_flaw(kept, test::deadlock_property(), *deadlock.trace), "");
  const PropertyResult late = check(kept, kept.properties[0], {});
  ASSERT_EQ(late.verdict, Verdict::violated);
  EXPECT_EQ(find_flaw(kept, kept.properties[0], *late.trace), "");
}

TEST(NativeEngine, TooManyProgramsAreInconclusive) {
  std::string text = "  busy: loop { sync.write; sync.read -> message; }\n";
  for (int i = 1; i < 1025; ++i) text += "  p" + std::to_string(i) + ": loop { sync.write; }\n";
  const System large = test::system_of(text, "  first: G F sync.write\n");
  EXPECT_EQ(check(large, test::deadlock_property()).verdict, Verdict::holds);
  const PropertyResult result = check(large, large.properties[0]);
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_THAT(result.reason, HasSubstr("at most 1024 programs"));
}

// Programs that count, apart from one another: (most + 1)^4 states.
System large_system(int most = 100, const std::string& last = "") {
  std::string programs;
  for (const char* name : {"a", "b", "c", "d"}) {
    programs += "  " + std::string(name) + ": \"repeat " + std::to_string(most) + " { if * {} } " +
                (*name == 'd' ? last : "") + "\"\n";
  }
  return test::system_of(programs);
}

// Whatever searches it finds and counts the same: 25^4 states, and a deadlock at the end of all.
void expect_all_of_large_system(const EngineOptions& options) {
  const System system = large_system(24);
  const System waits = large_system(24, "via.read -> message;");
  const PropertyResult all = check(system, test::deadlock_property(), options);
  EXPECT_EQ(all.verdict, Verdict::holds);
  EXPECT_EQ(all.states, 25U * 25 * 25 * 25);
  EXPECT_EQ(all.transitions, 8U * 24 * 25 * 25 * 25);
  const PropertyResult found = check(waits, test::deadlock_property(), options);
  EXPECT_EQ(found.verdict, Verdict::violated);
  EXPECT_EQ(found.trace->steps.size(), 4U * 24 + 1);
}

// Its levels are wide enough for several threads, and the table grows while they fill it.
TEST(NativeEngine, ThreadsFindAndCountTheSame) {
  for (const unsigned threads : {1U, 2U, 3U, 16U}) {
    EngineOptions options;
    options.threads = threads;
    expect_all_of_large_system(options);
  }
}

// A product is searched in parts: one a program that may be stuck; of these formulas one, behind
// the states in which the automaton waits, and two where there is nothing to wait for.
class CyclesInParts : public testing::Test {
 protected:
  std::vector<PropertyResult> check_all(const System& system, unsigned threads,
                                        Ranks* ranks = nullptr) const {
    EngineOptions options;
    options.threads = threads;
    options.states_a_thread = 8;
    options.ranks = ranks;
    std::vector<PropertyResult> results{check(system, stuck(), options)};
    for (const Property& property : system.properties) {
      results.push_back(check(system, property, options));
    }
    return results;
  }
  static void expect_same_counts(const std::vector<PropertyResult>& left,
                                 const std::vector<PropertyResult>& right) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      EXPECT_EQ(left[i].verdict, right[i].verdict) << left[i].name;
      EXPECT_EQ(left[i].states, right[i].states) << left[i].name;
      EXPECT_EQ(left[i].transitions, right[i].transitions) << left[i].name;
    }
  }

  const std::string counts_ = "\"repeat 4 { if * {} }\"\n";
  const std::string programs_ = "  a: " + counts_ + "  b: " + counts_ + "  c: " + counts_ +
                                "  d: loop { sync.write; sync.read -> message; }\n";
  const std::string formulas_ =
      "  once: G (a@end -> G F b@end)\n  either: '!(F G !a@end || F G !b@end)'\n"
      "  strong: {ltl: G F b@end, fairness: strong}\n";
  const System good_ = test::system_of(programs_, formulas_);
  const System bad_ = test::system_of(
      programs_ + "  e: \"repeat 5 { if * {} } via.read -> message;\"\n",
      formulas_ +
          "  late: {ltl: '!F e@end', fairness: strong}\n  never: G (a@end -> F G !b@end)\n");
};

TEST_F(CyclesInParts, ThreadsFindAndCountTheSame) {
  const auto one = check_all(good_, 1), one_bad = check_all(bad_, 1);
  for (const PropertyResult& result : one) {
    EXPECT_EQ(result.verdict, Verdict::holds) << result.name;
    EXPECT_GT(result.states, 150) << result.name;
  }
  EXPECT_EQ(one_bad.front().verdict, Verdict::violated);
  EXPECT_EQ(one_bad.back().verdict, Verdict::violated);
  const auto two_bad = check_all(bad_, 2);
  for (const unsigned threads : {2U, 5U}) {
    expect_same_counts(check_all(good_, threads), one);
    const auto several_bad = check_all(bad_, threads);
    expect_same_counts(several_bad, two_bad);
    for (std::size_t i = 0; i < one_bad.size(); ++i) {
      EXPECT_EQ(several_bad[i].verdict, one_bad[i].verdict) << one_bad[i].name;
      ASSERT_EQ(several_bad[i].trace.has_value(), one_bad[i].trace.has_value());
      if (!one_bad[i].trace) continue;
      EXPECT_EQ(several_bad[i].trace->steps, two_bad[i].trace->steps) << one_bad[i].name;
      EXPECT_EQ(several_bad[i].trace->loop_start, two_bad[i].trace->loop_start);
    }
  }
}

TEST_F(CyclesInParts, RanksFindAndCountTheSame) {
  const auto one = check_all(good_, 1), one_bad = check_all(bad_, 1);
  for (const unsigned size : {1U, 2U, 3U, 5U}) {
    test::RanksOfThreads ranks(size);
    const auto several = check_all(good_, size % 2 + 1, ranks.first());
    expect_same_counts(several, one);
    if (size > 1) {
      EXPECT_GT(several.front().sent_bytes, 0);
    }
    const auto several_bad = check_all(bad_, 1, ranks.first());
    for (std::size_t i = 0; i < one_bad.size(); ++i) {
      EXPECT_EQ(several_bad[i].verdict, one_bad[i].verdict) << one_bad[i].name;
    }
    const System large = large_system(20);
    EngineOptions options;
    options.states_a_thread = 8;
    options.ranks = ranks.first();
    options.memory_mib = 1;
    EXPECT_THAT(check(large, stuck(), options).reason, HasSubstr("more than 1 MiB"));
    std::stop_source source;
    source.request_stop();
    options.memory_mib.reset();
    options.control.stop = source.get_token();
    EXPECT_THAT(check(large, stuck(), options).reason, HasSubstr("interrupted"));
  }
}

// Two programs share a mutex, so one may starve, but not on strongly fair runs. A third goes round
// in a long circle. The first rank has no room to work out a run on which one starves.
TEST(NativeEngine, WhoStarvesOnWeaklyFairRunsIsNotStuckWhereMemoryEnds) {
  const System system = parse_system(
      "models:\n  m: {use: mutex}\nprograms:\n  a: 'loop { m.lock; m.unlock; }'\n"
      "  b: 'loop { m.lock; m.unlock; }'\n  c: 'loop { repeat 20000 { if * {} } }'\n",
      "system.yaml", test::test_model);
  test::RanksOfThreads ranks(3);
  EngineOptions options;
  options.reduction = Reduction::none;
  options.ranks = ranks.first();
  options.states_a_thread = 64;
  EXPECT_EQ(check(system, stuck(), options).verdict, Verdict::holds);
  options.memory_mib = 4;
  const PropertyResult limited = check(system, stuck(), options);
  EXPECT_EQ(limited.verdict, Verdict::holds) << limited.reason;
}

// A rank that does not understand the first one ends all: they would wait for it.
TEST(NativeEngineDeathTest, ARankOfAnotherVersionEndsAll) {
  test::Mailboxes boxes(2);
  boxes.put(0, 1, true, {1, 2, 3});
  test::MailboxRanks rank(boxes, 1);
  EXPECT_DEATH(serve_searches(rank), "rank 1 failed: the first rank's maide is of another version");
}

// The batches of one round are on their way while the next one is expanded.
TEST(NativeEngine, RanksFindAndCountTheSame) {
  for (const unsigned size : {1U, 2U, 3U, 5U}) {
    test::RanksOfThreads ranks(size);
    EngineOptions options;
    options.ranks = ranks.first();
    options.threads = size % 2 + 1;
    options.states_a_thread = 16;
    expect_all_of_large_system(options);
    options.memory_mib = 1;
    const PropertyResult limited = check(large_system(), test::deadlock_property(), options);
    EXPECT_EQ(limited.verdict, Verdict::inconclusive);
    EXPECT_THAT(limited.reason, HasSubstr("more than 1 MiB"));
    options.memory_mib.reset();
    std::stop_source source;
    source.request_stop();
    options.control.stop = source.get_token();
    const PropertyResult stopped = check(large_system(), test::deadlock_property(), options);
    EXPECT_EQ(stopped.verdict, Verdict::inconclusive);
    EXPECT_THAT(stopped.reason, HasSubstr("interrupted"));
  }
}

TEST(NativeEngine, LimitsMakeTheVerdictInconclusive) {
  EngineOptions options;
  options.reduction = Reduction::none;
  options.memory_mib = 1;
  const PropertyResult result = check(large_system(), test::deadlock_property(), options);
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_THAT(result.reason, HasSubstr("more than 1 MiB"));
  EXPECT_THAT(result.reason, HasSubstr("depth"));
  for (const unsigned threads : {1U, 2U}) {
    options.threads = threads;
    EXPECT_THAT(check(large_system(), stuck(), options).reason, HasSubstr("more than 1 MiB"));
  }
  // The states of the system fit, and parts of the product do not.
  const System system = large_system(20);
  options.memory_mib = 2;
  options.states_a_thread = 8;
  EXPECT_EQ(check(system, test::deadlock_property(), options).verdict, Verdict::holds);
  EXPECT_THAT(check(system, stuck(), options).reason, HasSubstr("more than 2 MiB"));
}

TEST(NativeEngine, StopsWhenTold) {
  std::stop_source source;
  source.request_stop();
  EngineOptions options;
  options.reduction = Reduction::none;
  options.control.stop = source.get_token();
  const PropertyResult result = check(large_system(), test::deadlock_property(), options);
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_THAT(result.reason, HasSubstr("interrupted"));
}

// `spinner` alone is enough in every state, and never comes to an end: what `p` does must not be
// put off for ever (the ignoring problem).
TEST(NativeEngine, ASpinnerHidesNoStepOfOthers) {
  const System system = test::system_of(
      "  spinner: loop { sync.write; sync.read -> message; }\n"
      "  p: via.write; via.write; via.write;\n",
      "  never: {always: '!p@end'}\n  goes_on: {ltl: F G !via.write, fairness: none}\n"
      "  idle: {ltl: F via.write, fairness: none}\n  served: F via.write\n");
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::holds);
  EXPECT_EQ(check(system, system.properties[2]).verdict, Verdict::violated);
  EXPECT_EQ(check(system, system.properties[3]).verdict, Verdict::holds);
  // The third write is beyond the bound of two.
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
  EXPECT_EQ(NativeEngine().find_cut(system, reduced()).verdict, Verdict::violated);
  const System waits = test::system_of(
      "  spinner: loop { sync.write; sync.read -> message; }\n  p: via.write; via.write;\n",
      "  never: {always: '!p@end'}\n");
  EXPECT_EQ(check(waits, waits.properties[0]).verdict, Verdict::violated);
  Property error;
  error.kind = Property::Kind::error;
  const System fails = test::system_of(
      "  spinner: loop { sync.write; sync.read -> message; }\n"
      "  p: 'var n: 0..1; via.write; via.write; n = n + 2;'\n");
  EXPECT_EQ(check(fails, error).verdict, Verdict::violated);
}

// A run that is cut ends there for everybody; what others do before must be seen all the same.
TEST(NativeEngine, ACutHidesNoStepOfOthers) {
  const System system =
      test::system_of("  a: repeat 3 { via.write; }\n  b: if * {} if * {} if * {}\n",
                      "  never: {always: '!b@end'}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::violated);
}

// Right after the write, before p's silent choice: a formula that sees such steps is not reduced.
TEST(NativeEngine, SilentStepsAfterAnEventCanBeSeen) {
  const System system = test::system_of(
      "  p: via.write; if * {}\n  q: sync.write;\n",
      "  apart: {ltl: 'G (via.write -> !(via.write U sync.write))', fairness: none}\n");
  const PropertyResult result = check(system, system.properties[0]);
  EXPECT_EQ(result.verdict, Verdict::violated);
  EXPECT_EQ(result.reduction, Reduction::none);
}

// What a model of `states` states does when inputs are given.
struct Given {
  StateId from;
  Symbol input;
  StateId to;
};

// A system of one model, `name`; `rest`: its programs and properties.
System system_with(const std::string& name, const std::vector<std::string>& inputs,
                   std::size_t states, const std::vector<Given>& steps, const std::string& rest) {
  InterfaceAutomaton automaton(Alphabet(inputs), Alphabet({"none"}), states);
  for (const auto& [from, input, to] : steps) {
    automaton.add_transition(from, {Action::Kind::input, input}, to);
  }
  return parse_system("models:\n  " + name + ": {file: model.dot}\n" + rest, "system.yaml",
                      [&](const ModelRequest&) { return automaton; });
}

// There are two places. b takes one, goes round its loop, and takes the other. So a, which could
// take a place before that, must also be seen to come too late.
TEST(NativeEngine, WhatALoopComesBackToIsSeen) {
  const System system = system_with(
      "places", {"take"}, 3, {{0, 0, 1}, {1, 0, 2}},
      "programs:\n  a: places.take; if * {}\n  b: loop { places.take; if * {} if * {} }\n"
      "properties:\n  served: {ltl: F a@end, fairness: none}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::violated);
}

// A door with two bolts that are drawn and shot apart, and shut again together. Who wants to pass
// can do so only while the first alone is drawn.
System door_system(const std::string& rest) {
  enum : Symbol { first, second, shut, pass };
  enum : StateId { none, only_first, only_second, both };
  return system_with("door", {"first", "second", "shut", "pass"}, 4,
                     {{none, first, only_first},
                      {none, second, only_second},
                      {only_first, second, both},
                      {only_second, first, both},
                      {both, shut, none},
                      {only_first, pass, only_first}},
                     rest);
}

// The second bolt before the first, again and again, and nobody could ever pass. In the other
// order, which `one` alone would be enough for as far as weak fairness goes, they could each time.
TEST(NativeEngine, StrongFairnessSeesWhatIsPossibleInEachOrder) {
  const System system = door_system(
      "programs:\n  one: loop { door.first; }\n  two: loop { door.second; door.shut; }\n"
      "  guest: door.pass;\n"
      "properties:\n  passes: {ltl: F guest@end, fairness: strong}\n");
  const PropertyResult result = check(system, system.properties[0]);
  EXPECT_EQ(result.verdict, Verdict::violated);
  EXPECT_EQ(result.reduction, Reduction::order);
}

// A machine that is turned and pressed, again and again, and wears out at some pressing; from it a
// ticket is picked, a blank or a prize, of which a prize alone can be cashed. A worn machine has
// blanks only, and after a prize was picked it does not wear out any more.
System machine_system(const std::string& rest) {
  enum : Symbol { turn, press, pick, cash };
  enum : StateId { idle, turned, worn, worn_turned };
  enum : StateId { none, blank, prize, cashed };
  const auto state = [](StateId phase, StateId ticket) { return 4 * phase + ticket; };
  std::vector<Given> steps;
  for (StateId ticket = none; ticket <= cashed; ++ticket) {
    steps.push_back({state(idle, ticket), turn, state(turned, ticket)});
    steps.push_back({state(turned, ticket), press, state(idle, ticket)});
    if (ticket <= blank) steps.push_back({state(turned, ticket), press, state(worn, ticket)});
    steps.push_back({state(worn, ticket), turn, state(worn_turned, ticket)});
    steps.push_back({state(worn_turned, ticket), press, state(worn, ticket)});
  }
  for (StateId phase = idle; phase <= worn_turned; ++phase) {
    steps.push_back({state(phase, none), pick, state(phase, blank)});
    if (phase <= turned) steps.push_back({state(phase, none), pick, state(phase, prize)});
    steps.push_back({state(phase, prize), cash, state(phase, cashed)});
  }
  return system_with("machine", {"turn", "press", "pick", "cash"}, 16, steps, rest);
}

// Whatever can be reached by picking, then pressing, can be reached by pressing, then picking. But
// not after each outcome of the press: the search goes on from a worn machine only, the other is
// where it began.
TEST(NativeEngine, WhatIsPutOffMustBePossibleAfterEachOutcome) {
  const System system = machine_system(
      "programs:\n  owner: loop { machine.turn; machine.press; }\n"
      "  player: machine.pick; machine.cash;\n"
      "properties:\n  loses: {always: '!player@end'}\n");
  EngineOptions options;
  options.reduction = Reduction::order;
  EXPECT_EQ(check(system, system.properties[0], options).verdict, Verdict::violated);
}

// The formula goes on before the system does, and by itself: no step of the run.
TEST(NativeEngine, AFormulaThatMovesAloneIsNoStep) {
  const System system = parse_system(
      "models: {m: {use: mutex}}\nprograms: {p: \"@l m.lock; m.lock;\"}\n"
      "properties:\n  both: {ltl: \"(G true) && (G F p@l)\", fairness: none}\n"
      "  either: {ltl: \"(G F true) R (G F p@l)\", fairness: none}\n",
      "s.yaml", test::test_model);
  for (const Property& property : system.properties) {
    const PropertyResult result = check(system, property);
    EXPECT_EQ(result.verdict, Verdict::violated) << property.name << result.reason;
    EXPECT_EQ(result.trace->steps.size(), 1u) << property.name;
  }
}

TEST(NativeEngine, IndependentProgramsTakeTheirStepsInOneOrder) {
  EngineOptions options;
  options.reduction = Reduction::order;
  const PropertyResult result = check(large_system(), test::deadlock_property(), options);
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_EQ(result.reduction, Reduction::order);
  EXPECT_EQ(result.states, 401u);
}

TEST(NativeEngine, StatesWithASingleStepArePassedBy) {
  const System system =
      test::system_of("  p: via.write; via.write; sync.write;\n", "  never: {always: '!p@end'}\n");
  const PropertyResult result = check(system, test::deadlock_property());
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_EQ(result.reduction, Reduction::full);
  EXPECT_EQ(result.states, 2u);
  EXPECT_EQ(result.transitions, 3u);
  const PropertyResult ends = check(system, system.properties[0]);
  ASSERT_EQ(ends.verdict, Verdict::violated);
  EXPECT_EQ(ends.trace->steps.size(), 3u);
}

// n programs that each hold a mutex of their own, again and again.
System holders(unsigned count, const std::string& formula) {
  std::string models = "models:\n", programs = "programs:\n";
  for (unsigned i = 0; i < count; ++i) {
    const std::string model = "m" + std::to_string(i);
    models += "  " + model + ": {use: mutex}\n";
    programs +=
        "  p" + std::to_string(i) + ": loop { @a " + model + ".lock; @b " + model + ".unlock; }\n";
  }
  return parse_system(models + programs + "properties: {f: \"" + formula + "\"}\n", "system.yaml",
                      test::test_model);
}

std::string assumptions(unsigned count) {
  std::string text;
  for (unsigned i = 0; i < count; ++i) {
    const std::string program = "p" + std::to_string(i);
    text += (i == 0 ? "" : " && ") + ("(G F " + program + "@a -> G F " + program + "@b)");
  }
  return text;
}

EngineOptions seconds(double most) {
  EngineOptions options;
  options.threads = 1;
  options.control.deadline = deadline_in(most);
  return options;
}

// The system has 2^n states. A plain automaton of the assumptions has 2^n states of its own.
TEST(NativeEngine, AssumptionsOfFairnessCostNoStates) {
  for (const unsigned count : {2U, 6U, 8U}) {
    const std::string follows = "(" + assumptions(count) + ") -> G (p0@a -> F p0@b)";
    const System response = holders(count, follows);
    const PropertyResult holds = check(response, response.properties.front(), seconds(60));
    EXPECT_EQ(holds.verdict, Verdict::holds);
    EXPECT_LE(holds.states, 2U << count);
    EXPECT_LE(holds.transitions, 2 * count << count);
    const System denial = holders(count, "!(" + assumptions(count) + ")");
    const PropertyResult violated = check(denial, denial.properties.front(), seconds(60));
    ASSERT_EQ(violated.verdict, Verdict::violated);
    EXPECT_LE(violated.states, 1U << count);
    EXPECT_EQ(violated.trace->steps.size(), 2 * count);
  }
  // As many automata beside each other as there are assumptions.
  const System each = holders(6, assumptions(6));
  const PropertyResult holds = check(each, each.properties.front(), seconds(60));
  EXPECT_EQ(holds.verdict, Verdict::holds);
  EXPECT_LE(holds.states, 3 * 6 << 6);
}

// 42 pairs, whose marks are more than a word has bits: whoever is somewhere again and again is
// everywhere again and again.
TEST(NativeEngine, ManyAssumptionsOfFairness) {
  std::vector<std::string> places;
  for (const char* program : {"p0", "p1", "p2"}) {
    for (const char* label : {"@a", "@b"}) places.push_back(std::string(program) + label);
  }
  places.emplace_back("(p0@a && p1@b)");
  std::string all = "true";
  for (const std::string& from : places) {
    for (const std::string& to : places) {
      if (from != to) all += " && (G F " + from + " -> G F " + to + ")";
    }
  }
  const System follows = holders(3, "(" + all + ") -> G F (p0@a && p1@b)");
  const PropertyResult holds = check(follows, follows.properties.front(), seconds(60));
  EXPECT_EQ(holds.verdict, Verdict::holds);
  EXPECT_LE(holds.states, 3U << 3);
  const System denial = holders(3, "!(" + all + ")");
  EXPECT_EQ(check(denial, denial.properties.front(), seconds(60)).verdict, Verdict::violated);
  const System beyond = holders(3, "(" + all + ") -> G F (p0@a && p1@a && p2@b)");
  EXPECT_EQ(check(beyond, beyond.properties.front(), seconds(60)).verdict, Verdict::violated);
}

// Under X assumptions are not taken for what they are.
TEST(NativeEngine, ATranslationHearsTheDeadline) {
  const System system = holders(10, "!X (" + assumptions(10) + ")");
  const auto start = std::chrono::steady_clock::now();
  const PropertyResult result = check(system, system.properties.front(), seconds(0.2));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_THAT(result.reason, HasSubstr("out of time"));
}

}  // namespace
}  // namespace maide
