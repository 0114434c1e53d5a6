// Messages on their way: what a late message can change, and what it cannot. The systems are small,
// and each shows one thing. Random systems are held against an interpreter with wires of its own in
// tests/referee.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/packed/packed_system.hpp"
#include "maide/check/rules/wire.hpp"
#include "maide/check/search/search.hpp"
#include "maide/check/search/search_job.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "mailbox_ranks.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

System wired(const std::string& text, Deliveries deliveries = Deliveries::as_said) {
  return parse_system(text, "s.yaml", test::test_model, {}, {}, deliveries);
}

CheckReport check_wired(const System& system, Reduction reduction = Reduction::none) {
  NativeEngine engine;
  CheckRequest request;
  request.options.reduction = reduction;
  return check_system(system, engine, request);
}

// The verdict on the property, which all reductions agree on.
std::string verdict_of(const std::string& text, const std::string& property) {
  const System system = wired(text);
  std::string common;
  for (const Reduction reduction : {Reduction::none, Reduction::order, Reduction::full}) {
    const CheckReport report = check_wired(system, reduction);
    for (const PropertyResult& result : report.properties) {
      if (result.name != property) continue;
      const std::string found = to_string(result.verdict);
      if (!common.empty() && common != found) return common + ", and " + found;
      common = found;
    }
  }
  return common;
}

std::string changed(const std::string& text, const std::string& what, const std::string& by) {
  std::string other = text;
  for (std::size_t at = other.find(what); at != std::string::npos;
       at = other.find(what, at + by.size())) {
    other.replace(at, what.size(), by);
  }
  EXPECT_NE(other, text) << what;
  return other;
}

// A chart is written, then a bell rings on another topic.
const std::string chart_and_bell =
    "topics:\n"
    "  chart: {writers: [desk], readers: [pilot], use: queue, with: {depth: 3}}\n"
    "  bell: {writers: [desk], readers: [pilot], use: queue, with: {depth: 3}}\n"
    "programs:\n"
    "  desk: \"chart.write; bell.write;\"\n"
    "  pilot: \"bell.read -> message; switch chart.tryread { message { skip; } null { @blind skip; "
    "} }\"\n"
    "properties: {seen: \"G !pilot@blind\"}\n";

TEST(Wires, AMessageOfAnotherTopicMayComeFirst) {
  EXPECT_EQ(verdict_of(chart_and_bell, "seen"), "violated");
  EXPECT_EQ(
      verdict_of(changed(chart_and_bell, "use: queue", "delivery: at_once, use: queue"), "seen"),
      "holds");
}

// Each topic decides for itself: one that is late is enough.
TEST(Wires, TheBellAloneIsLate) {
  const std::string text = changed(chart_and_bell, "chart: {", "chart: {delivery: at_once, ");
  EXPECT_EQ(verdict_of(text, "seen"), "holds");
}

TEST(Wires, AtRestEverythingArrivesAtOnce) {
  const System late = wired(chart_and_bell), at_rest = wired(chart_and_bell, Deliveries::at_rest);
  EXPECT_FALSE(late.nobodys_actions.empty());
  EXPECT_TRUE(at_rest.nobodys_actions.empty());
  EXPECT_LT(at_rest.models.size(), late.models.size());
  EXPECT_EQ(at_rest.programs.size(), late.programs.size());
}

TEST(Wires, OneTopicKeepsItsOrder) {
  const std::string text =
      "topics: {t: {writers: a, readers: b, use: queue, with: {depth: 5}, delivery: late}}\n"
      "programs:\n"
      "  a: \"t.write(1); t.write(2); t.write(3);\"\n"
      "  b: \"var x: 0..3; var y: 0..3; t.read -> message(x); t.read -> message(y); @two skip;\"\n"
      "properties: {order: {always: \"b@two -> b.x == 1 && b.y == 2\"}}\n";
  EXPECT_EQ(verdict_of(text, "order"), "holds");
  // A writer that keeps one may lose the first two, but not their order.
  const std::string one = changed(text, "{depth: 5}", "{depth: 5, pub-depth: 1}");
  EXPECT_EQ(verdict_of(one, "order"), "violated");
  const std::string sorted = changed(one, "b.x == 1 && b.y == 2", "b.x < b.y");
  EXPECT_EQ(verdict_of(sorted, "order"), "holds");
}

// What was sent last is never lost on the way.
TEST(Wires, TheNewestIsKept) {
  const std::string text =
      "topics: {t: {writers: a, readers: b, use: queue, with: {depth: 2, pub-depth: 1}}}\n"
      "programs: {a: \"t.write(1); t.write(2);\", b: \"var x: 0..2; loop { idle t.read -> "
      "message(x); }\"}\n"
      "properties: {newest: \"F b.x == 2\", first: \"F b.x == 1\"}\n";
  EXPECT_EQ(verdict_of(text, "newest"), "holds");
  EXPECT_EQ(verdict_of(text, "first"), "violated");
  EXPECT_EQ(verdict_of(changed(text, ", pub-depth: 1", ""), "first"), "holds");
}

// A queue that refuses takes no more because some of it is on the way.
TEST(Wires, AWireAddsNoRoom) {
  const std::string text =
      "topics: {t: {writers: [a, b], readers: r, use: queue, with: {size: 1}, delivery: late}}\n"
      "programs: {a: \"t.write;\", b: \"t.write;\", r: \"skip; if (1 == 2) { t.read -> message; "
      "}\"}\n"
      "properties: {both: {always: \"!(a@end && b@end)\"}}\n";
  EXPECT_EQ(verdict_of(text, "both"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "violated");
}

// So who tests whether a write is possible finds it full as soon as that is on its way.
TEST(Wires, WhatIsOnItsWayMayFillAQueue) {
  const std::string text =
      "topics: {t: {writers: a, readers: r, use: queue, with: {size: 1}, delivery: late}}\n"
      "programs:\n"
      "  a: \"t.write; select { on t.write { @second skip; } otherwise { @full skip; } }\"\n"
      "  r: \"skip; if (1 == 2) { t.read -> message; }\"\n"
      "properties: {early: \"!a@full W t!arrives\", second: \"G !a@second\"}\n";
  EXPECT_EQ(verdict_of(text, "early"), "violated");
  EXPECT_EQ(verdict_of(text, "second"), "holds");
}

TEST(Wires, WhatIsLostMakesRoom) {
  const std::string text =
      "topics: {t: {writers: a, readers: r, use: queue, with: {size: 1}, delivery: late, loses: "
      "true}}\n"
      "programs: {a: \"t.write; t.write;\", r: \"skip; if (1 == 2) { t.read -> message; }\"}\n"
      "properties: {sent: {possible: \"a@end\"}}\n";
  EXPECT_EQ(verdict_of(text, "sent"), "holds");
  EXPECT_EQ(verdict_of(changed(text, "loses: true", "loses: false"), "sent"), "violated");
}

TEST(Wires, WhatArrivesMayAlwaysComeOnFairRuns) {
  const std::string text =
      "topics: {t: {writers: a, readers: b, use: queue, with: {depth: 1}}}\n"
      "programs: {a: \"t.write;\", b: \"@waits t.read -> message;\", c: \"loop { if * { skip; } "
      "else { skip; } }\"}\n"
      "properties: {comes: \"F b@end || F c@end\"}\n";  // c runs beside them
  EXPECT_EQ(verdict_of(text, "comes"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
}

// Something of what is sent again and again comes, though each message may be lost.
TEST(Wires, NotAllIsLostForEver) {
  const std::string text =
      "topics: {t: {writers: a, readers: b, use: queue, with: {depth: 1}, loses: true}}\n"
      "programs: {a: \"loop { t.write; }\", b: \"loop { t.read -> message; @has skip; }\"}\n"
      "properties: {again: \"G F b@has\"}\n";
  EXPECT_EQ(verdict_of(text, "again"), "holds");
  const std::string once = changed(text, "loop { t.write; }", "t.write;");
  EXPECT_EQ(verdict_of(changed(once, "G F b@has", "F b@has"), "again"), "violated");
  EXPECT_EQ(
      verdict_of(changed(changed(once, "G F b@has", "F b@has"), "loses: true", "loses: false"),
                 "again"),
      "holds");
}

TEST(Wires, ADeadWritersMessageArrivesOrIsLost) {
  const std::string text =
      "topics: {t: {writers: a, readers: b, use: queue, with: {depth: 1}}}\n"
      "programs: {a: {do: \"t.write; t.write;\", may_die: true}, b: \"idle t.read -> message; @has "
      "skip;\"}\n"
      "properties: {comes: \"G (a@end -> F b@has)\", sent: \"G (t.write -> F b@has)\", never: "
      "\"G !b@has\"}\n";
  EXPECT_EQ(verdict_of(text, "never"), "violated");
  EXPECT_EQ(verdict_of(text, "comes"), "violated");
  EXPECT_EQ(verdict_of(text, "sent"), "violated");
  EXPECT_EQ(verdict_of(changed(text, "may_die: true", "may_die: false"), "sent"), "holds");
}

const std::string answer_and_note =
    "topics: {note: {writers: server, readers: client, use: queue, with: {depth: 2}}}\n"
    "services: {s: {server: server, clients: client, delivery: late}}\n"
    "programs:\n"
    "  server: \"s.serve -> request; note.write; s.answer;\"\n"
    "  client: \"s.send; s.receive -> answer; switch note.tryread { message { skip; } null { "
    "@missed skip; } }\"\n"
    "properties: {noted: \"G !client@missed\"}\n";

// ---- one order for several wires ----------------------------------------------------------------

TEST(Wires, AStreamKeepsOneOrder) {
  const std::string text = changed(chart_and_bell, "use: queue", "stream: tcp, use: queue");
  EXPECT_EQ(verdict_of(text, "seen"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
  EXPECT_EQ(verdict_of(text, "stuck"), "holds");
  // Two streams, or two processes, race.
  EXPECT_EQ(verdict_of(changed(text, "bell: {writers: [desk], readers: [pilot], stream: tcp",
                               "bell: {writers: [desk], readers: [pilot], stream: udp"),
                       "seen"),
            "violated");
  const std::string loses = changed(text, "stream: tcp", "loses: true, stream: tcp");
  EXPECT_EQ(verdict_of(loses, "seen"), "violated");
}

TEST(Wires, AStreamIsOfTwoProcesses) {
  const std::string text =
      "topics:\n"
      "  chart: {writers: desk, readers: pilot, use: queue, with: {depth: 1}, stream: tcp}\n"
      "  go: {writers: desk, readers: clerk, use: queue, with: {depth: 1}, stream: tcp}\n"
      "  bell: {writers: clerk, readers: pilot, use: queue, with: {depth: 1}, stream: tcp}\n"
      "programs:\n"
      "  desk: {do: \"chart.write; go.write;\", process: a}\n"
      "  clerk: {do: \"go.read -> message; bell.write;\", process: b}\n"
      "  pilot: {do: \"bell.read -> message; switch chart.tryread { message { skip; } null { "
      "@blind "
      "skip; } }\", process: c}\n"
      "properties: {seen: \"G !pilot@blind\"}\n";
  EXPECT_EQ(verdict_of(text, "seen"), "violated");
  EXPECT_EQ(verdict_of(changed(text, "process: b", "process: a"), "seen"), "holds");
  EXPECT_EQ(verdict_of(changed(text, "process: b", "process: c"), "seen"), "holds");
}

// A dead reader's messages do not stand before those of others.
// The death of r forgets more than the code of a step holds.
System with_kept_codes() {
  return wired(R"yaml(topics:
  t: {writers: [a, b], readers: [r], use: queue, with: {depth: 2}}
  u: {writers: [r], readers: [c], use: queue, with: {depth: 2}}
programs:
  a: "t.write(1);"
  b: "t.write(2);"
  r: {do: "t.read -> message; u.write;", may_die: true}
  c: "u.read -> message;"
properties:
  comes: "G (a@end -> F t!arrives(1))"
)yaml");
}

TEST(Wires, WhatADeathForgetsMayBeMoreThanACodeOfAStepHolds) {
  const System system = with_kept_codes();
  EXPECT_TRUE(PackedSystem(system).has_kept_codes());
  for (const unsigned threads : {1U, 3U}) {
    NativeEngine engine;
    CheckRequest request;
    request.options.threads = threads;
    const CheckReport report = check_system(system, engine, request);
    for (const char* const name : {"deadlock", "comes"}) {
      const auto result = std::ranges::find(report.properties, name, &PropertyResult::name);
      ASSERT_NE(result, report.properties.end());
      EXPECT_EQ(result->verdict, Verdict::violated);
      EXPECT_TRUE(result->trace.has_value());
    }
  }
}

// What is kept beside the codes of steps is of one process, and in no file.
TEST(Wires, KeptCodesAreRefusedBySeveralProcessesAndCheckpoints) {
  const System system = with_kept_codes();
  using Goal = SearchJob::Goal;
  const auto refusal = [&](Goal goal, const std::string& property, const SearchLimits& limits) {
    try {
      explore(system, goal, find_property(system, property), Reduction::none, limits, {});
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string said = "s.yaml: its steps forget too much for ";
  const std::string what = ": a reader's death, with all that is on its way to it";
  test::RanksOfThreads ranks(2);
  SearchLimits several;
  several.ranks = ranks.first();
  EXPECT_EQ(refusal(Goal::deadlock, "deadlock", several), said + "several processes" + what);
  EXPECT_EQ(refusal(Goal::cycle, "stuck", several), said + "several processes" + what);
  const TempDir folder("maide-test-");
  SearchLimits saved;
  saved.checkpoints = folder.path().string();
  EXPECT_EQ(refusal(Goal::deadlock, "deadlock", saved), said + "a checkpoint" + what);
  EXPECT_EQ(refusal(Goal::deadlock, "deadlock", {}), "");
}

TEST(Wires, AServiceInAStreamHasFewClients) {
  const std::string text = R"(services:
  s: {server: q, clients: [c], stream: tcp}
programs:
  q: "loop { idle s.serve -> request; s.answer; }"
  c[i in 0..7]: "s.send; s.receive -> answer;"
)";
  EXPECT_EQ(wired(text).services.front().clients.size(), 8U);
  try {
    wired(changed(text, "0..7", "0..8"));
    FAIL() << "nine clients are taken";
  } catch (const ParseError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a service with `stream` has at most 8 clients"));
    EXPECT_THAT(error.what(), HasSubstr("(s.yaml:2:"));
  }
}

TEST(KeptLists, HaveANumberEach) {
  KeptLists lists(2);
  const std::vector<std::vector<std::uint32_t>> all{{1, 2}, {2, 1}, {3}};
  std::set<std::uint64_t> numbers;
  for (const auto& list : all) {
    const std::uint64_t number = lists.number_of(list);
    EXPECT_EQ(lists.number_of(list), number);
    EXPECT_EQ(lists.at(number), list);
    EXPECT_LT(number, 4U);
    numbers.insert(number);
  }
  EXPECT_EQ(numbers.size(), all.size());
  EXPECT_THROW(lists.number_of(std::vector<std::uint32_t>{4}), UsageError);
}

TEST(Wires, AStreamForgetsTheDead) {
  const std::string text =
      "topics:\n"
      "  a: {writers: p, readers: q, use: queue, with: {size: 1}, delivery: late, stream: s}\n"
      "  b: {writers: p, readers: r, use: queue, with: {depth: 1}, stream: s}\n"
      "programs:\n"
      "  p: \"a.write; b.write;\"\n"
      "  q: {do: \"idle a.read -> message;\", may_die: true, process: x}\n"
      "  r: {do: \"b.read -> message;\", process: x}\n"
      "properties: {comes: \"F r@end\"}\n";
  EXPECT_EQ(verdict_of(text, "comes"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
}

// Each wire of a stream keeps what its writer keeps.
TEST(Wires, AStreamLosesByWire) {
  const std::string text =
      "topics:\n"
      "  a: {writers: p, readers: q, use: queue, with: {depth: 5, pub-depth: 1}, stream: s}\n"
      "  b: {writers: p, readers: q, use: queue, with: {depth: 5, pub-depth: 5}, stream: s}\n"
      "programs:\n"
      "  p: \"a.write(1); b.write; a.write(2);\"\n"
      "  q: \"var x: 0..2; b.read -> message; a.read -> message(x);\"\n"
      "properties: {first: \"F q.x == 1\", b: \"G !b!lost\", order: \"!a!arrives(2) U "
      "b!arrives\"}\n";
  EXPECT_EQ(verdict_of(text, "first"), "violated");
  EXPECT_EQ(verdict_of(text, "b"), "holds");
  EXPECT_EQ(verdict_of(text, "order"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
}

TEST(Wires, AStreamIsOfTopicsAndModels) {
  EXPECT_EQ(
      verdict_of("models:\n"
                 "  a: {use: queue, with: {depth: 1}, delivery: late, stream: s}\n"
                 "  b: {use: queue, with: {depth: 1}, delivery: late, stream: s}\n"
                 "programs:\n"
                 "  p: \"a.write; b.write;\"\n"
                 "  q: \"b.read -> message; switch a.tryread { message { skip; } null { @misses "
                 "skip; } }\"\n"
                 "properties: {there: \"G !q@misses\"}\n",
                 "there"),
      "holds");
}

// What a server writes and answers goes one way, and a request the other.
TEST(Wires, AStreamIsOfServicesToo) {
  const std::string name = answer_and_note;
  EXPECT_EQ(verdict_of(name, "noted"), "violated");
  const std::string of_both =
      changed(changed(name, "clients: client", "clients: client, stream: s"), "use: queue",
              "stream: s, use: queue");
  EXPECT_EQ(verdict_of(of_both, "noted"), "holds");
  EXPECT_EQ(verdict_of(of_both, "deadlock"), "holds");
  const std::string of_two =
      changed(of_both, "clients: client, stream: s", "clients: client, stream: other");
  EXPECT_EQ(verdict_of(of_two, "noted"), "violated");
}

// Two services: the first request is served first, and the first answer comes first.
TEST(Wires, AStreamOrdersServices) {
  const std::string text =
      "services:\n"
      "  one: {server: s, clients: c, stream: t}\n"
      "  two: {server: s, clients: c, stream: t}\n"
      "programs:\n"
      "  s: |\n"
      "    two.serve -> request;\n"
      "    select { on one.serve -> request { } otherwise { @blind skip; } }\n"
      "  c: \"one.send; two.send;\"\n"
      "properties: {there: \"G !s@blind\"}\n";
  EXPECT_EQ(verdict_of(text, "there"), "holds");
  EXPECT_EQ(verdict_of(changed(text, ", stream: t", ""), "there"), "violated");
  // What is lost is out of the order.
  const std::string loses = changed(text, "clients: c", "clients: c, loses: true");
  EXPECT_EQ(verdict_of(loses, "there"), "violated");
}

// The order of what was sent has no bound of its own where a writer goes round for ever.
TEST(Wires, AStreamOfALoopIsBoundedByItsWires) {
  const std::string text =
      "topics:\n"
      "  a: {writers: p, readers: q, use: queue, with: {size: 1}, delivery: late, stream: s}\n"
      "  b: {writers: p, readers: q, use: queue, with: {size: 1}, delivery: late, stream: s}\n"
      "programs:\n"
      "  p: \"loop { a.write; b.write; }\"\n"
      "  q: |\n"
      "    loop {\n"
      "      idle b.read -> message;\n"
      "      select { on a.read -> message { } otherwise { @blind skip; } }\n"
      "    }\n"
      "properties: {there: \"G !q@blind\"}\n";
  EXPECT_EQ(verdict_of(text, "there"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
}

// A client that sends more than is kept pushes out its own oldest, and the order knows it.
TEST(Wires, AStreamOfAServiceLosesTheOldest) {
  const std::string text =
      "topics: {note: {writers: c, readers: s, use: queue, with: {depth: 1}, stream: t}}\n"
      "services: {ask: {server: s, clients: c, stream: t, with: {depth: 1}}}\n"
      "programs:\n"
      "  s: \"note.read -> message; @noted ask.serve -> request; @asked skip;\"\n"
      "  c: \"repeat 12 { ask.send; } note.write;\"\n"
      "properties: {asked: \"F s@asked\", free: {always: \"!c@end || true\"}}\n";
  EXPECT_EQ(verdict_of(text, "asked"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
}

// ---- waiting until it has arrived ---------------------------------------------------------------

const std::string waits_for_chart =
    changed(chart_and_bell, "chart.write; bell", "chart.write; wait chart -> arrived; bell");

TEST(Wires, AWriterMayWaitUntilAllHasArrived) {
  EXPECT_EQ(verdict_of(waits_for_chart, "seen"), "holds");
  EXPECT_EQ(verdict_of(waits_for_chart, "deadlock"), "holds");
  EXPECT_EQ(verdict_of(waits_for_chart, "stuck"), "holds");
  const std::string at_once =
      changed(waits_for_chart, "use: queue", "delivery: at_once, use: queue");
  EXPECT_EQ(verdict_of(at_once, "seen"), "holds");
  EXPECT_EQ(verdict_of(at_once, "deadlock"), "holds");
  // It waits for what was sent before, and not for the bell.
  const std::string before =
      changed(chart_and_bell, "chart.write; bell", "wait chart -> arrived; chart.write; bell");
  EXPECT_EQ(verdict_of(before, "seen"), "violated");
}

TEST(Wires, ItWaitsForItsOwnMessages) {
  const std::string text =
      "topics: {t: {writers: [a, b], readers: r, use: queue, with: {depth: 2}}}\n"
      "programs:\n"
      "  a: \"t.write(1); wait t -> arrived; @done skip;\"\n"
      "  b: \"t.write(2); @sent skip;\"\n"
      "  r: \"loop { idle t.read -> message; }\"\n"
      "properties: {own: \"!a@done W t!arrives(1)\"}\n";
  EXPECT_EQ(verdict_of(text, "own"), "holds");
}

TEST(Wires, OneReaderMayBeEnough) {
  const std::string text =
      changed(changed(waits_for_chart, "readers: [pilot]", "readers: [pilot, log]"), "properties:",
              "  log: \"idle chart.read -> message; idle bell.read -> message;\"\nproperties:");
  EXPECT_EQ(verdict_of(text, "seen"), "holds");
  EXPECT_EQ(verdict_of(changed(text, "wait chart", "wait chart[pilot]"), "seen"), "holds");
  EXPECT_EQ(verdict_of(changed(text, "wait chart", "wait chart[log]"), "seen"), "violated");
}

TEST(Wires, AnArmTakesWhatHasArrived) {
  const std::string text =
      changed(chart_and_bell, "bell.write;",
              "select { on chart!arrived { bell.write; } timeout 5 { @late bell.write; } }");
  EXPECT_EQ(verdict_of(text, "seen"), "violated");
  const std::string only = changed(text, "@late bell.write;", "@late skip;");
  EXPECT_EQ(verdict_of(only, "seen"), "holds");
  EXPECT_EQ(verdict_of(only, "deadlock"), "violated");
  // There is nothing to wait for.
  const std::string at_once = changed(only, "use: queue", "delivery: at_once, use: queue");
  EXPECT_EQ(verdict_of(at_once, "deadlock"), "holds");
  EXPECT_EQ(verdict_of(changed(at_once, "G !pilot@blind", "G !desk@late"), "seen"), "holds");
}

// What is on its way to the dead keeps nobody waiting.
TEST(Wires, ADeadReaderHasArrived) {
  const std::string text =
      "topics: {t: {writers: a, readers: [b, c], use: queue, with: {size: 1}, delivery: late}}\n"
      "programs:\n"
      "  a: \"t.write; t.write; wait t -> arrived; @done skip;\"\n"
      "  b: {do: \"t.read -> message; t.read -> message;\", may_die: true}\n"
      "  c: \"loop { idle t.read -> message; }\"\n"
      "properties: {done: \"F a@done\"}\n";
  EXPECT_EQ(verdict_of(text, "done"), "holds");
  EXPECT_EQ(verdict_of(text, "deadlock"), "holds");
}

TEST(Wires, ACallbackWaitsForItsNodesMessages) {
  const std::string text =
      "topics:\n"
      "  chart: {writers: desk, readers: pilot, use: queue, with: {depth: 1}}\n"
      "  bell: {writers: desk, readers: pilot, use: queue, with: {depth: 1}}\n"
      "programs: {pilot: \"bell.read -> message; switch chart.tryread { message { } null { @blind "
      "skip; } }\"}\n"
      "nodes: {desk: {callbacks: {tick: {timer: 5, do: \"chart.write; wait chart -> arrived; "
      "bell.write;\"}}}}\n"
      "properties: {seen: \"G !pilot@blind\"}\n";
  EXPECT_EQ(verdict_of(text, "seen"), "holds");
  EXPECT_EQ(verdict_of(changed(text, "wait chart -> arrived; ", ""), "seen"), "violated");
}

TEST(Wires, WhoSendsNothingWaitsForNothing) {
  const auto error = [](const std::string& what, const std::string& by) {
    return test::error_of([&] { wired(changed(waits_for_chart, what, by)); });
  };
  EXPECT_THAT(error("message; switch", "message; wait chart -> arrived; switch"),
              HasSubstr("this program is no writer of chart (s.yaml:6:47)"));
  EXPECT_THAT(error("wait chart", "wait chart[desk]"),
              HasSubstr("'desk' is no reader of chart; there is: pilot (s.yaml:5:34)"));
  EXPECT_THAT(error("wait chart", "wait chart[1]"), HasSubstr("'chart' is no array"));
  EXPECT_THAT(error("-> arrived", "-> arrived(1)"), HasSubstr("'arrived' carries no values"));
  EXPECT_THAT(test::error_of([] {
                wired("models: {m: {use: mutex}}\nprograms: {a: \"m.lock; wait m -> arrived;\"}\n");
              }),
              HasSubstr("model m has no output 'arrived'"));
  EXPECT_THAT(test::error_of([&] {
                wired(changed(answer_and_note, "s.send; ", "s.send; wait s -> arrived; "));
              }),
              HasSubstr("its answer says that it has (s.yaml:5:30)"));
}

// ---- services -----------------------------------------------------------------------------------

TEST(Wires, AnAnswerToANodeMayOvertakeAMessage) {
  EXPECT_EQ(verdict_of(answer_and_note, "noted"), "violated");
  // The note cannot be late behind an answer that is.
  EXPECT_EQ(
      verdict_of(changed(answer_and_note, "use: queue", "delivery: at_once, use: queue"), "noted"),
      "holds");
}

TEST(Wires, RequestsAndAnswersThatAreLateAllArrive) {
  const std::string text =
      "services: {s: {server: server, clients: [one, two], delivery: late}}\n"
      "programs:\n"
      "  server: \"repeat 2 { s.serve -> request; s.answer; }\"\n"
      "  one: \"s.send; s.receive -> answer;\"\n"
      "  two: \"s.send; s.receive -> answer;\"\n"
      "properties: {all: \"F (one@end && two@end)\"}\n";
  EXPECT_EQ(verdict_of(text, "all"), "holds");
  EXPECT_EQ(verdict_of(changed(text, "delivery: late", "delivery: late, loses: true"), "all"),
            "violated");
}

TEST(Wires, RequestsAndAnswersMayAlwaysComeOnFairRuns) {
  const std::string text =
      "services: {s: {server: server, clients: client, delivery: late}}\n"
      "programs:\n"
      "  server: \"s.serve -> request; s.answer;\"\n"
      "  client: \"s.send; s.receive -> answer;\"\n"
      "  other: \"loop { if * { skip; } else { skip; } }\"\n"
      "properties: {served: \"F server@end || F other@end\", answered: \"F client@end || F "
      "other@end\"}\n";
  EXPECT_EQ(verdict_of(text, "served"), "holds");
  EXPECT_EQ(verdict_of(text, "answered"), "holds");
}

// ---- where there are no wires -------------------------------------------------------------------

bool is_late(const std::string& text) { return !wired(text).nobodys_actions.empty(); }

// Nor does who hands over at once take the room of what is on its way, or say that there is some.
TEST(Wires, WhatIsOnItsWayKeepsItsRoomFromWhoHandsOverAtOnce) {
  const System system = parse_system(
      "topics: {t: {writers: [a, b], readers: r, file: s.dot, when_unexplored: wait}}\n"
      "programs:\n"
      "  a: {do: \"select { on t.write { @wrote skip; } otherwise { @no skip; } }\", process: p}\n"
      "  b: {do: \"t.write; t.write;\", process: q}\n"
      "  r: {do: \"skip; if (1 == 2) { t.read -> message; }\", process: p}\n"
      "properties: {both: \"G !(a@wrote && b@end)\", full: \"G !a@no\"}\n",
      "s.yaml", [](const ModelRequest& request) {
        ModelRequest local = request;
        local.file = "strict-2.dot";
        InterfaceAutomaton automaton = test::test_model(local);
        automaton.origin["sul"] = "cyclonedds history=keep_all max-samples=2";
        return automaton;
      });
  std::map<std::string, Verdict> verdicts;
  for (const PropertyResult& result : check_wired(system).properties) {
    verdicts[result.name] = result.verdict;
  }
  EXPECT_EQ(verdicts["deadlock"], Verdict::violated);  // a's and one of b's
  EXPECT_EQ(verdicts["full"], Verdict::violated);      // both of b's, on their way
  EXPECT_EQ(verdicts["both"], Verdict::holds);
}

TEST(Wires, LieBetweenProcessesAlone) {
  const std::string text =
      "topics: {t: {writers: a, readers: b, file: cyclonedds.dot}}\n"
      "programs:\n"
      "  a: {do: \"t.write;\", process: p}\n"
      "  b: {do: \"t.read -> message;\", process: q}\n";
  const auto of = [&](const std::string& sul, const std::string& processes) {
    const System system = parse_system(processes, "s.yaml", [&](const ModelRequest& request) {
      ModelRequest local = request;
      local.file = "strict-2.dot";
      InterfaceAutomaton automaton = test::test_model(local);
      automaton.origin["sul"] = sul;
      return automaton;
    });
    return !system.nobodys_actions.empty();
  };
  const std::string joined = changed(text, "process: q", "process: p");
  EXPECT_TRUE(of("cyclonedds depth=2", text));
  EXPECT_FALSE(of("cyclonedds depth=2", joined));
  EXPECT_FALSE(of("ros2 depth=2 rmw=cyclonedds", joined));
  EXPECT_TRUE(of("ros2 depth=2 rmw=fastrtps", joined));  // nobody measured it
  EXPECT_TRUE(of("fastdds depth=2", text));
  EXPECT_FALSE(of("fastdds depth=2", joined));
  EXPECT_TRUE(of("fastdds depth=2 transport=udp", joined));
  EXPECT_TRUE(of("zeromq size=2", text));
  EXPECT_FALSE(of("zeromq size=2", joined));
  EXPECT_TRUE(of("zeromq size=2 transport=tcp", joined));
  EXPECT_TRUE(of("zeromq pattern=req-rep", joined));
  EXPECT_TRUE(of("ros1 queue_size=2", joined));
  EXPECT_FALSE(of("ros1 queue_size=2 transport=intraprocess", joined));
  EXPECT_TRUE(of("mqtt size=2", joined));
  EXPECT_FALSE(of("yarp carrier=tcp", text));  // its writer waits
  EXPECT_TRUE(of("yarp carrier=tcp kind=buffered", text));
}

// Nodes say when messages come late.
TEST(Wires, NodesHaveThemToo) {
  const std::string text =
      "topics: {t: {writers: p, readers: n.on_t, use: queue, with: {depth: 1}}}\n"
      "programs: {p: \"t.write;\"}\n"
      "nodes: {n: {callbacks: {on_t: {takes: t.read, do: \"skip;\"}}}}\n";
  EXPECT_TRUE(is_late(text));
  EXPECT_EQ(verdict_of(text, "stuck"), "holds");
  EXPECT_FALSE(is_late(changed(text, "{writers: p", "{delivery: at_once, writers: p")));
}

// The map's answer and what it publishes race, unless both ends are in one process.
TEST(Wires, AnAnswerMayOvertakeAMessage) {
  const std::string text =
      "topics: {chart: {writers: map, readers: robot.on_chart, use: queue, with: {depth: 1}}}\n"
      "services: {ask: {server: map, clients: [robot]}}\n"
      "programs: {map: \"ask.serve -> request; chart.write; ask.answer;\"}\n"
      "nodes:\n"
      "  robot:\n"
      "    variables: \"var has_chart: bool; var answered: bool;\"\n"
      "    clients: {ask: {do: \"answered = true;\"}}\n"
      "    callbacks:\n"
      "      start: {timer: 100, do: \"ask.send;\"}\n"
      "      on_chart: {takes: chart.read, do: \"has_chart = true;\"}\n"
      "properties: {p: {always: \"robot.answered -> robot.has_chart\"}}\n";
  EXPECT_EQ(verdict_of(text, "p"), "violated");
  EXPECT_EQ(verdict_of(changed(text, "server: map,", "server: map, delivery: at_once,"), "p"),
            "violated");
}

TEST(Wires, WhatIsBuiltInIsThereAtOnce) {
  EXPECT_FALSE(
      is_late("models: {q: {use: queue, with: {size: 2}}, m: {use: mutex}}\n"
              "programs: {a: \"m.lock; q.write; m.unlock;\", b: \"q.read -> message;\"}\n"));
  EXPECT_TRUE(
      is_late("models: {q: {use: queue, with: {size: 2}, delivery: late}}\n"
              "programs: {a: \"q.write;\", b: \"q.read -> message;\"}\n"));
}

// ---- what is said of them -----------------------------------------------------------------------

TEST(Wires, AssumptionsSayWhatIsLate) {
  const CheckReport report = check_wired(wired(chart_and_bell));
  EXPECT_THAT(report.assumptions,
              testing::Contains(HasSubstr("chart, bell: what is sent arrives some time later")));
}

TEST(Wires, StepsOfNobodyHaveNames) {
  const System system = wired(changed(chart_and_bell, "depth: 3", "depth: 3, pub-depth: 1"));
  std::vector<std::string> texts;
  for (const NobodysAction& action : system.nobodys_actions) texts.push_back(action.what.text);
  EXPECT_THAT(texts, testing::UnorderedElementsAre("chart!arrives", "chart!lost", "bell!arrives",
                                                   "bell!lost"));
}

TEST(Wires, FormulasNameArrivals) {
  const std::string text =
      changed(chart_and_bell, "seen: \"G !pilot@blind\"",
              "first: \"!bell!arrives U chart!arrives\", none: \"G !bell!lost\"");
  EXPECT_EQ(verdict_of(text, "first"), "violated");
  EXPECT_EQ(verdict_of(text, "none"), "holds");
  const std::string at_once = changed(text, "use: queue", "delivery: at_once, use: queue");
  EXPECT_EQ(verdict_of(at_once, "none"), "holds");
}

// Of values, and of one client: where all arrives at once they are false, and a remark says so.
TEST(Wires, AtomsOfWhatArrivesAtOnceNeverHold) {
  const std::string text =
      "topics: {data: {writers: a, readers: b, use: queue, with: {depth: 2}, delivery: late}}\n"
      "services: {ask: {server: a, clients: [b, c], delivery: late}}\n"
      "programs:\n"
      "  a: \"data.write(1); loop { idle ask.serve -> request; ask.answer; }\"\n"
      "  b: \"data.read -> message(var x);\"\n"
      "  c: \"ask.send; ask.receive -> answer;\"\n"
      "properties:\n"
      "  one: \"G !data!arrives(1)\"\n"
      "  two: \"G !ask[c]!request_arrives\"\n";
  EXPECT_EQ(verdict_of(text, "one"), "violated");
  EXPECT_EQ(verdict_of(text, "two"), "violated");
  EXPECT_THAT(wired(text).remarks, Not(testing::Contains(HasSubstr("at once"))));
  const std::string at_once = changed(text, "delivery: late", "delivery: at_once");
  EXPECT_EQ(verdict_of(at_once, "one"), "holds");
  EXPECT_EQ(verdict_of(at_once, "two"), "holds");
  EXPECT_THAT(wired(at_once).remarks,
              testing::Contains("data!arrives(1) never holds: it arrives at once (s.yaml:8:8)"));
  EXPECT_THAT(
      wired(at_once).remarks,
      testing::Contains("ask[c]!request_arrives never holds: it arrives at once (s.yaml:9:8)"));
  EXPECT_THAT(test::error_of([&] { wired(changed(at_once, "arrives(1)", "arrives(x)")); }),
              HasSubstr("has no output 'arrives(x)'"));
}

// A formula sees in which order messages arrive, whatever a reduction leaves out.
TEST(Wires, FormulasTellArrivalsApart) {
  const std::string text =
      "topics:\n"
      "  a: {writers: p, readers: q, use: queue, with: {depth: 1}}\n"
      "  b: {writers: p, readers: q, use: queue, with: {depth: 1}}\n"
      "programs: {p: \"a.write; b.write;\", q: \"a.read -> message; b.read -> message;\"}\n"
      "properties: {b_last: \"G (a!arrives -> F b!arrives)\", a_last: \"G (b!arrives -> F "
      "a!arrives)\"}\n";
  EXPECT_EQ(verdict_of(text, "b_last"), "violated");
  EXPECT_EQ(verdict_of(text, "a_last"), "violated");
}

TEST(Wires, APublisherKeepsAtLeastOne) {
  EXPECT_THAT(
      test::error_of([] { wired(changed(chart_and_bell, "depth: 3", "depth: 3, pub-depth: 0")); }),
      HasSubstr("'pub-depth' is a number of at least 1"));
}

// ---- the model of a wire ------------------------------------------------------------------------

TEST(WireModel, HoldsTenMessagesOrWhatItsWriterKeeps) {
  for (const std::uint32_t kept : {1U, 4U, 10U, 12U}) {
    WireModel wire({kept, false}, {"write"});
    InterfaceAutomaton automaton = wire.start();
    ASSERT_TRUE(wire.make_all(automaton, false, 1000));
    EXPECT_EQ(automaton.size(), std::max(kept, 10U) + 1) << kept;
  }
}

TEST(WireModel, SaysWhatItHolds) {
  WireModel wire({0, false}, {"write(3)", "write(5)"});
  InterfaceAutomaton automaton = wire.start();
  EXPECT_FALSE(wire.make_all(automaton, false, 100));
  EXPECT_EQ(wire.describe(0), "");
  EXPECT_EQ(wire.describe(1), "a message: 3");
}

}  // namespace
}  // namespace maide
