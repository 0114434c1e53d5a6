// Anybody at ends of topics and services, holes, first values and places in other files. What
// anybody does is held against closed systems that were made by hand: programs that write, ask and
// answer at any time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

System system_from(const std::string& text) { return parse_system(text, "s.yaml", test_model); }

CheckReport report_of(const System& system, const std::vector<std::string>& properties = {}) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = properties;
  return check_system(system, engine, request);
}

// "deadlock holds, stuck violated, ...", of the named properties.
std::string verdicts(const std::string& text, const std::vector<std::string>& properties) {
  const System system = system_from(text);
  std::string line;
  for (const std::string& name : properties) {
    const PropertyResult result = report_of(system, {name}).properties.front();
    line += (line.empty() ? "" : ", ") + name + " " + describe_verdict(result);
    if (result.trace && result.verdict == Verdict::violated) {
      EXPECT_EQ(find_flaw_in_parts(system, find_property(system, name), *result.trace), "");
    }
  }
  return line;
}

std::uint64_t states_of(const std::string& text) {
  return report_of(system_from(text), {"deadlock"}).properties.front().states;
}

std::string place_text(const System& system, const Step& step) {
  const auto origin = origin_of(system, step);
  return origin ? to_string(*origin) : "";
}

// ---- topics -------------------------------------------------------------------------------------

const std::string reader =
    "  r: |\n"
    "    var last: 0..3;\n"
    "    loop {\n"
    "      scan.read -> message(last);\n"
    "      @got skip;\n"
    "      if (last == 2) { @two skip; stop; }\n"
    "    }\n";
const std::string of_reader =
    "properties:\n"
    "  got: \"F r@got\"\n"
    "  ends: \"F r@two\"\n"
    "  two: {possible: \"r@two\"}\n"
    "  three: {possible: \"r.last == 3\"}\n"
    "  back: {always_possible: \"r@end\"}\n";

TEST(OpenEnds, ATopicThatAnybodyWritesIsRead) {
  const std::vector<std::string> all{"deadlock", "stuck", "got", "ends", "two", "three", "back"};
  const std::string open =
      "topics: {scan: {writers: anybody, readers: r, values: [1, 2]}}\n"
      "programs:\n" +
      reader + of_reader;
  EXPECT_EQ(verdicts(open, all),
            "deadlock holds, stuck holds, got violated, ends violated, two possible, "
            "three not possible, back holds");
  std::string fair = open;
  fair.replace(fair.find("values"), 0, "fair: true, ");
  EXPECT_EQ(verdicts(fair, all),
            "deadlock holds, stuck holds, got holds, ends violated, two possible, "
            "three not possible, back holds");
  // Who writes at any time, and for ever.
  const std::string closed =
      "topics: {scan: {writers: w, readers: r, use: queue, with: {size: 1}}}\n"
      "programs:\n"
      "  w: \"loop { idle select { on scan.write(1) { } on scan.write(2) { } } }\"\n" +
      reader + of_reader;
  EXPECT_EQ(verdicts(closed, all), verdicts(fair, all));
}

TEST(OpenEnds, AnybodyWritesBesideOthers) {
  const std::string open =
      "topics: {scan: {writers: [w, anybody], readers: r, use: queue, with: {size: 1}, "
      "values: 2..3}}\n"
      "programs:\n  w: \"scan.write(1);\"\n" +
      reader + of_reader;
  EXPECT_EQ(verdicts(open, {"got", "ends", "two", "three", "stuck"}),
            "got holds, ends violated, two possible, three possible, stuck holds");
}

TEST(OpenEnds, WhatIsWrittenToAnybodyVanishes) {
  const std::string text =
      "topics: {out: {writers: w, readers: anybody}}\n"
      "programs:\n  w: \"for k in 0..3 { out.write(k); }\"\n"
      "properties: {ends: \"F w@end\"}\n";
  EXPECT_EQ(verdicts(text, {"ends"}), "ends holds");
  EXPECT_EQ(states_of(text), 6U);  // before each write, at the end; and one of anybody
}

TEST(OpenEnds, AnybodyMayBeLateForTimeOutsAndLooks) {
  const std::string text =
      "topics: {scan: {writers: anybody, readers: [r, p]}}\n"
      "programs:\n"
      "  r: \"loop { select { on scan.read -> message { @got skip; } timeout 10 { @late skip; } } "
      "}\"\n"
      "  p: \"loop { switch scan.tryread { message { @got skip; } null { @none skip; } } }\"\n"
      "properties:\n"
      "  both: {possible: \"r@got && p@got\"}\n"
      "  none: {possible: \"r@late && p@none\"}\n"
      "  waits: \"G F r@late\"\n";
  EXPECT_EQ(verdicts(text, {"both", "none", "stuck"}), "both possible, none possible, stuck holds");
  EXPECT_EQ(verdicts(text, {"waits"}), "waits violated");
}

// ---- services -----------------------------------------------------------------------------------

TEST(OpenEnds, AnybodyAsks) {
  const std::string text =
      "services: {s: {server: q, clients: anybody}}\n"
      "programs: {q: \"loop { s.serve -> request; @asked s.answer; }\"}\n"
      "properties: {asked: \"F q@asked\", can: {possible: \"q@asked\"}}\n";
  EXPECT_EQ(verdicts(text, {"deadlock", "stuck", "asked", "can"}),
            "deadlock holds, stuck holds, asked violated, can possible");
  EXPECT_EQ(verdicts("services: {s: {server: q, clients: anybody}}\n"
                     "programs: {q: \"s.serve -> request; s.answer; s.answer;\"}\n",
                     {"deadlock"}),
            "deadlock violated");  // it answers one request twice
}

TEST(OpenEnds, AnybodyAsksBesideOthers) {
  const std::string text =
      "services: {s: {server: q, clients: [c, anybody], with: {depth: 2}}}\n"
      "programs:\n"
      "  q: \"loop { idle s.serve -> request; s.answer; }\"\n"
      "  c: \"s.send; s.receive -> answer; @done skip;\"\n"
      "properties: {done: {possible: \"c@end\"}, sure: {ltl: \"F c@end\", fairness: strong}}\n";
  // Two of his push the request out.
  EXPECT_EQ(verdicts(text, {"done", "sure", "stuck"}),
            "done possible, sure violated, stuck violated");
}

const std::string client =
    "  c: \"wait s -> there; s.send; @asked s.receive -> answer; @done skip;\"\n"
    "properties: {done: \"F c@end\"}\n";

TEST(OpenEnds, AnybodyAnswers) {
  const std::string open = "services: {s: {server: anybody, clients: c}}\nprograms:\n" + client;
  EXPECT_EQ(verdicts(open, {"deadlock", "stuck", "done"}),
            "deadlock holds, stuck holds, done holds");
  const std::string closed =
      "services: {s: {server: q, clients: c}}\nprograms:\n"
      "  q: \"loop { idle s.serve -> request; s.answer; }\"\n" +
      client;
  EXPECT_EQ(verdicts(closed, {"deadlock", "stuck", "done"}),
            verdicts(open, {"deadlock", "stuck", "done"}));
  EXPECT_LT(states_of(open), states_of(closed));
  std::string silent = open;
  silent.replace(silent.find("clients"), 0, "may_not_answer: true, ");
  EXPECT_EQ(verdicts(silent, {"deadlock", "done"}), "deadlock violated, done violated");
  EXPECT_THAT(report_of(system_from(open)).assumptions,
              Contains("s: anybody is the server; he comes at some time, stays, and answers each "
                       "request at last, in any order"));
}

TEST(OpenEnds, WhatIsSentBeforeHeIsThereIsLost) {
  EXPECT_EQ(verdicts("services: {s: {server: anybody, clients: c}}\n"
                     "programs: {c: \"s.send; s.receive -> answer;\"}\n",
                     {"stuck", "deadlock"}),
            "stuck holds, deadlock violated");
}

TEST(OpenEnds, AnswersToSeveralRequestsComeInAnyOrder) {
  const std::string text =
      "services: {s: {server: anybody, clients: n}}\n"
      "executors: {e: {kind: multi, threads: 2}}\n"
      "nodes:\n"
      "  n:\n"
      "    executor: e\n"
      "    threads: {a: \"wait s -> there; s.send; wait s -> answer; @a skip; skip;\",\n"
      "              b: \"wait s -> there; s.send; wait s -> answer; @b skip; skip;\"}\n"
      "properties:\n"
      "  a: {ltl: \"F n.a@a\", fairness: strong}\n"
      "  b: {ltl: \"F n.b@b\", fairness: strong}\n";
  EXPECT_EQ(verdicts(text, {"a", "b", "stuck"}), "a holds, b holds, stuck holds");
}

TEST(OpenEnds, ByRoundsALookMayMissWhatAnybodySentAndFindsItAtLast) {
  const std::string text =
      "topics: {scan: {writers: anybody, readers: n}}\n"
      "services: {s: {server: anybody, clients: n}}\n"
      "executors: {e: {kind: single, order: rounds}}\n"
      "nodes:\n"
      "  n:\n"
      "    executor: e\n"
      "    threads: {t: \"wait s -> there; s.send; wait s -> answer; @d skip;\"}\n"
      "    callbacks:\n"
      "      on_scan: {takes: scan.read, do: \"@scan skip;\"}\n"
      "      tick: {timer: 10, do: \"skip;\"}\n"
      "properties:\n"
      "  d: {ltl: \"F n.t@d\", fairness: strong}\n"
      "  scans: {ltl: \"F n.on_scan@scan\", fairness: strong}\n";
  EXPECT_EQ(verdicts(text, {"d", "scans", "stuck"}), "d holds, scans violated, stuck holds");
}

TEST(OpenEnds, AnOpenNodeHasFewerStatesThanAClosedOne) {
  std::string topics, services, callbacks, programs, clients;
  const auto node = [&](bool is_open) {
    topics = services = callbacks = programs = clients = "";
    for (const char letter : std::string("abc")) {
      const std::string name(1, letter);
      topics += "  " + name + ": {writers: " + (is_open ? "anybody" : "w_" + name) +
                ", readers: n, use: queue, with: {depth: 1}}\n";
      callbacks += "      on_" + name + ": {takes: " + name + ".read, do: \"skip;\"}\n";
      if (!is_open) programs += "  w_" + name + ": \"loop { " + name + ".write; }\"\n";
    }
    return "topics:\n" + topics + (programs.empty() ? "" : "programs:\n" + programs) +
           "nodes:\n  n:\n    callbacks:\n" + callbacks;
  };
  const std::uint64_t open = states_of(node(true)), closed = states_of(node(false));
  EXPECT_EQ(open, 4U);  // it looks, or runs one of three
  EXPECT_GT(closed, 4 * open);
}

TEST(OpenEnds, OldFilesMayHaveAProgramOfThatName) {
  const std::string text =
      "topics: {scan: {writers: anybody, readers: r, use: queue, with: {size: 1}}}\n"
      "programs: {anybody: \"scan.write;\", r: \"scan.read -> message; @got skip;\"}\n"
      "properties: {got: \"F r@got\"}\n";
  EXPECT_EQ(verdicts(text, {"got"}), "got holds");
}

TEST(OpenEnds, WhatMakesNoSenseIsRefused) {
  const auto error = [](const std::string& text) {
    return error_of([&] { system_from(text + "programs: {r: \"skip;\"}\n"); });
  };
  EXPECT_THAT(error("topics: {t: {writers: r, readers: r, use: queue, values: [a]}}\n"),
              HasSubstr("'values' goes with `writers: anybody`"));
  EXPECT_THAT(error("topics: {t: {writers: anybody, readers: anybody}}\n"),
              HasSubstr("is read by somebody of the file"));
  EXPECT_THAT(error("topics: {t: {writers: anybody, readers: r, file: x.dot}}\n"),
              HasSubstr("leave out 'file'"));
  EXPECT_THAT(error("topics: {t: {writers: anybody, readers: r, values: 3..1}}\n"),
              HasSubstr("is no range"));
  EXPECT_THAT(error("services: {s: {server: anybody, clients: anybody}}\n"),
              HasSubstr("one end of a service"));
  EXPECT_THAT(error("services: {s: {server: r, clients: r, may_not_answer: true}}\n"),
              HasSubstr("'may_not_answer' goes with `server: anybody`"));
}

// ---- holes --------------------------------------------------------------------------------------

TEST(Holes, NothingHoldsAndViolationsStand) {
  const System system = system_from(
      "holes: [the recovery is not written, nor is the start]\n"
      "programs: {p: \"@here skip; if * { @far skip; } else { skip; }\"}\n"
      "properties: {near: \"F p@here\", far: \"F p@far\"}\n");
  const CheckReport report = report_of(system);
  EXPECT_EQ(report.verdict, Verdict::violated);
  for (const PropertyResult& result : report.properties) {
    const bool is_far = result.name == "far";
    EXPECT_EQ(result.verdict, is_far ? Verdict::violated : Verdict::inconclusive) << result.name;
    if (is_far) continue;
    EXPECT_THAT(result.reason, HasSubstr("the file leaves out: the recovery is not written"));
    EXPECT_THAT(result.reason, HasSubstr("the file leaves out: nor is the start"));
  }
  EXPECT_THAT(report.doubts, Contains("the file leaves out: nor is the start"));
  EXPECT_EQ(exit_status_of(report_of(system, {"near"})), ExitStatus::inconclusive);
}

// ---- first values -------------------------------------------------------------------------------

TEST(FirstValues, AreAllValuesOfTheType) {
  const std::string text =
      "variables: \"var n: 0..2 = any; var b: bool = any;\"\n"
      "nodes: {v: {variables: \"var m: {slow, fast} = any;\", callbacks: {t: {timer: once 1, do: "
      "\"if (m == fast) { @fast skip; } else { @slow skip; }\"}}}}\n"
      "programs:\n"
      "  p: \"var own: {go, halt} = any; if (own == halt && n > 1 && b) { @all skip; }\"\n"
      "  q: \"if (n == 0 || b) { @some skip; } else { @none skip; }\"\n"
      "properties:\n"
      "  all: {possible: \"p@all\"}\n"
      "  none: {possible: \"q@none\"}\n"
      "  fast: {possible: \"v@fast\"}\n"
      "  slow: {possible: \"v@slow\"}\n"
      "  kept: \"G (n == 2 -> G n == 2)\"\n"
      "  one: \"F (q@some || q@none)\"\n";
  EXPECT_EQ(verdicts(text, {"all", "none", "fast", "slow", "kept", "one"}),
            "all possible, none possible, fast possible, slow possible, kept holds, one holds");
}

TEST(FirstValues, AreChosenBeforeAnybodyElseSteps) {
  const System system = system_from(
      "variables: \"var n: 0..2 = any;\"\n"
      "programs: {p: \"n = 1;\", q: \"if (n == 2) { skip; }\"}\n");
  const std::vector<Step> steps = enabled_steps(system, initial_state(system));
  EXPECT_EQ(steps.size(), 3U);
  for (const Step& step : steps) EXPECT_EQ(actor_name(system, step.actor), "first values");
}

// ---- always possible ----------------------------------------------------------------------------

TEST(AlwaysPossible, AsksFromEveryState) {
  const System system = system_from(
      "variables: \"var at: 0..2;\"\n"
      "programs:\n"
      "  p: \"loop { if * { at = 1; at = 0; } else { if * { at = 2; loop { if * { } else { } } } } "
      "}\"\n"
      "  q: \"if (at == 0) { skip; }\"\n"
      "properties:\n"
      "  home: {always_possible: \"at == 0\"}\n"
      "  away: {always_possible: \"at > 0\"}\n"
      "  gone: {always_possible: \"at == 2\"}\n");
  const PropertyResult home = report_of(system, {"home"}).properties.front();
  EXPECT_EQ(home.verdict, Verdict::violated);
  ASSERT_TRUE(home.trace.has_value());
  EXPECT_EQ(find_flaw_in_parts(system, find_property(system, "home"), *home.trace), "");
  EXPECT_EQ(home.trace->steps.size(), 3U);  // else, if, at = 2
  EXPECT_EQ(report_of(system, {"away"}).properties.front().verdict, Verdict::holds);
  EXPECT_EQ(report_of(system, {"gone"}).properties.front().verdict, Verdict::holds);
}

TEST(AlwaysPossible, IsOfEventsAndKnowsBounds) {
  const std::string text =
      "topics: {image: {writers: w, readers: r, use: queue, with: {depth: unknown}, "
      "delivery: at_once}}\n"
      "programs: {w: \"loop { image.write; }\", r: \"loop { image.read -> message; }\"}\n"
      "properties: {comes: {always_possible: \"image!message\"}, asked: {always_possible: "
      "\"image.write\"}}\n";
  EXPECT_EQ(verdicts(text, {"asked"}), "asked inconclusive");
  EXPECT_EQ(verdicts("models: {m: {use: mutex}}\n"
                     "programs: {p: \"m.lock;\", q: \"m.lock; m.unlock;\"}\n"
                     "properties: {unlocked: {always_possible: \"m.unlock\"}, lock: "
                     "{always_possible: \"p@end\"}}\n",
                     {"unlocked", "lock"}),
            "unlocked violated, lock holds");
}

// ---- places in other files ----------------------------------------------------------------------

TEST(Origins, StandBehindStatements) {
  const System system = system_from(
      "models: {q: {use: queue, with: {size: 1}}}\n"
      "programs:\n"
      "  p: |\n"
      "    q.write at \"node.cpp:12\";\n"
      "    if * { skip; } else { skip; } at \"src/node.cpp:14:3\"\n");
  const std::vector<Step> first = enabled_steps(system, initial_state(system));
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(place_text(system, first[0]), "node.cpp:12");
  const auto next = apply(system, initial_state(system), first[0]);
  const std::vector<Step> second = enabled_steps(system, next);
  ASSERT_EQ(second.size(), 2U);
  EXPECT_EQ(place_text(system, second[1]), "src/node.cpp:14:3");
  system_from("programs: {p: 'if * { unknown at \"a.cpp:1\"; } end at \"a.cpp:2\";'}\n");
  system_from(
      "executors: {e: {kind: single, main: 'spin some at \"a.cpp:1\"; spin at \"a.cpp:2\";'}}\n"
      "nodes: {n: {executor: e, callbacks: {c: {timer: 1, do: 'skip;'}}}}\n");
  EXPECT_THAT(error_of([] { system_from("programs: {p: 'skip at \"node.cpp\";'}\n"); }),
              HasSubstr("behind 'at' stands a place"));
}

}  // namespace
}  // namespace maide::test
