// Code that spins its executor: `main:`, and starts of nodes. What rclcpp (Humble) does: a spin
// runs the callbacks of what it is given alone, and a node that has been added cannot be spun
// again.
#include <gtest/gtest.h>

#include <string>

#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"
#include "verdict_cases.hpp"

namespace maide {
namespace {

using test::H;
using test::V;

// A node that asks a server elsewhere, and what spins it.
std::string asks(
    const std::string& main, const std::string& server = "lookup.answer;",
    const std::string& rest = "callbacks: {on_go: {takes: go.read, do: \"@went skip;\"}}",
    const std::string& order = "any") {
  return "topics: {go: {writers: world, readers: robot, use: queue, with: {depth: 2}}}\n"
         "services: {lookup: {server: map, clients: [robot]}}\n"
         "programs: {world: \"go.write;\"}\n"
         "executors: {main: {kind: single, order: " +
         order + ", main: \"" + main +
         "\"}}\nnodes:\n  map: {callbacks: {find: {serves: lookup, do: \"" + server +
         "\"}}}\n  robot:\n    executor: main\n    variables: \"var n: 0..3;\"\n    " + rest +
         "\nproperties:\n  went: {possible: \"robot.on_go@went\"}\n" +
         (main.find("@got") == std::string::npos
              ? ""
              : "  got: {ltl: \"F robot.main@got\", fairness: strong}\n"
                "  late: {possible: \"robot.main@late\"}\n");
}
const std::string with_timer =
    "callbacks: {on_go: {takes: go.read, do: \"@went skip;\"}, tick: {timer: 5, do: \"skip;\"}}";
const std::string until = "lookup.send; spin until lookup -> answer; @got skip; @late skip; spin;";
const std::string until_late =
    "lookup.send; spin until lookup -> answer timeout 500 { @late skip; } @got skip; spin;";
const std::string waits_there = "lookup.send; wait lookup -> answer; @got skip; @late skip; spin;";

// Nodes that share an executor; one asks the other as it starts.
std::string starts(const std::string& start, const std::string& server_executor) {
  return "services: {lookup: {server: map, clients: [robot]}}\n"
         "executors: {main: {kind: single}, other: {kind: single}}\nnodes:\n"
         "  map: {executor: " +
         server_executor +
         ", callbacks: {find: {serves: lookup, do: \"lookup.answer;\"}}}\n"
         "  robot: {executor: main, start: \"lookup.send; " +
         start +
         " @up skip;\", callbacks: {on_tick: {timer: once 5, do: \"skip;\"}}}\n"
         "properties: {up: {ltl: \"F robot.start@up\", fairness: strong}}\n";
}

// Two messages come, and callbacks count them.
std::string counts(const std::string& main, const std::string& order = "any",
                   const std::string& more = "") {
  return "topics: {scan: {writers: lidar, readers: robot, use: queue, with: {depth: 2}}}\n"
         "programs: {lidar: \"scan.write; scan.write;\"}\n"
         "variables: \"var n: 0..3;\"\n"
         "executors: {main: {kind: single, order: " +
         order + ", main: \"" + main +
         " @done skip;\"}}\nnodes:\n  robot: {executor: main, callbacks: {on_scan: {takes: "
         "scan.read, do: \"n = n + 1;\"}" +
         more +
         "}}\nproperties:\n  done: {ltl: \"F robot.main@done\", fairness: strong}\n"
         "  none: {possible: \"robot.main@done && n == 0\"}\n"
         "  one: {possible: \"robot.main@done && n == 1\"}\n"
         "  two: {possible: \"robot.main@done && n == 2\"}\n";
}
const std::string tick = ", tick: {timer: 10, do: \"skip;\"}";

// A callback's `wait` beside its client's own code.
std::string beside(const std::string& threads) {
  return "services: {lookup: {server: map, clients: [robot]}}\n"
         "executors: {main: {kind: multi, threads: " +
         threads +
         "}}\nnodes:\n  map: {callbacks: {find: {serves: lookup, do: \"lookup.answer;\"}}}\n"
         "  robot:\n    executor: main\n    groups: {own: exclusive}\n"
         "    clients: {lookup: {group: own, do: \"@told skip;\"}}\n"
         "    callbacks: {go: {timer: once 5, do: \"lookup.send; wait lookup -> answer; @got "
         "skip;\"}}\n"
         "properties:\n  both: {ltl: \"F robot.go@got && F robot.lookup@told\", fairness: "
         "strong}\n";
}

const test::VerdictCase spin_systems[] = {
    {"until", "deadlock", H, asks(until)},
    {"until", "got", H, asks(until)},
    {"until", "went", H, asks(until)},
    {"until_unanswered", "deadlock", V, asks(until, "skip;")},
    {"until_unanswered", "got", V, asks(until, "skip;")},
    {"until_late", "deadlock", H, asks(until_late, "skip;")},
    {"until_late", "got", H, asks(until_late, "skip;")},
    {"until_late", "late", H, asks(until_late)},
    {"until_late_twice", "got", H,
     asks("repeat 2 { lookup.send; spin until lookup -> answer timeout 5 { skip; } } @got skip; "
          "@late skip; spin;")},
    // Real time goes on while callbacks run.
    {"until_late_and_a_timer", "got", H, asks(until_late, "skip;", with_timer)},
    {"until_and_a_timer", "stuck", "inconclusive", asks(until, "skip;", with_timer)},
    {"until_and_a_timer_answered", "stuck", H, asks(until, "lookup.answer;", with_timer)},
    {"waits_in_main", "deadlock", V, asks(waits_there)},
    {"waits_in_main", "went", V, asks(waits_there)},
    {"until_with_code", "got", H,
     asks(
         until, "lookup.answer;",
         "clients: {lookup: {do: \"n = 1;\"}}\n    callbacks: {on_go: {takes: go.read, do: \"@went "
         "skip;\"}}")},
    // In a start the node alone is spun.
    {"start_elsewhere", "up", H, starts("spin until lookup -> answer;", "other")},
    {"start_elsewhere", "deadlock", H, starts("spin until lookup -> answer;", "other")},
    {"start_same", "up", V, starts("spin until lookup -> answer;", "main")},
    {"start_same", "deadlock", V, starts("spin until lookup -> answer;", "main")},
    {"start_same_late", "up", H, starts("spin until lookup -> answer timeout 5 { }", "main")},
    {"start_waits", "deadlock", V, starts("wait lookup -> answer;", "other")},
    // Some, all, one.
    {"once", "two", V, counts("spin once;")},
    {"once", "one", H, counts("spin once;")},
    {"once_twice", "two", H, counts("spin once; spin once;")},
    {"once_thrice", "deadlock", V, counts("spin once; spin once; spin once;")},
    {"once_late", "deadlock", H, counts("repeat 3 { spin once timeout 5 { } }")},
    {"some", "none", H, counts("spin some;")},
    {"some", "one", H, counts("spin some;")},
    {"some", "two", V, counts("spin some;")},
    {"some", "done", H, counts("spin some;", "any", tick)},
    {"some_by_rounds", "two", V, counts("spin some;", "rounds", tick)},
    {"some_by_rounds", "one", H, counts("spin some;", "rounds", tick)},
    {"some_until_two", "done", H, counts("while (n < 2) { spin some; }", "any", tick)},
    {"some_until_two", "two", H, counts("while (n < 2) { spin some; }", "rounds", tick)},
    {"some_of_one", "one", H, counts("spin some 1;", "any", tick)},
    // A label holds until the first step.
    {"labelled", "first", H,
     counts("@first spin all;") + "  first: \"G (n == 1 -> !robot.main@first)\"\n"},
    {"all", "two", H, counts("spin all;")},
    {"all", "none", H, counts("spin all;")},
    {"all_by_rounds", "two", H, counts("spin all;", "rounds")},
    {"all_of_one", "two", V, counts("spin all 1;")},
    {"all_of_two", "two", H, counts("spin all 2;")},
    {"spins_for_ever", "done", V, counts("spin;")},
    {"spins_for_ever", "deadlock", H, counts("spin;")},
    {"ends_too_early", "deadlock", H, counts("skip;")},
    {"timer_once", "deadlock", V,
     counts("spin all; spin once; spin once; spin once; spin once;", "any",
            ", tick: {timer: once 10, do: \"skip;\"}")},
    {"wait_beside_code", "both", H, beside("2")},
    {"wait_beside_code", "deadlock", H, beside("2")},
    {"spin_in_a_callback", "error", V,
     asks("spin;", "lookup.answer;",
          "callbacks: {on_go: {takes: go.read, do: \"@went skip; lookup.send; spin until lookup -> "
          "answer;\"}}")},
};

class SpinSystems : public testing::TestWithParam<test::VerdictCase> {};

TEST_P(SpinSystems, HaveTheVerdictsThatTheyMustHave) { test::expect_verdict(GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, SpinSystems, testing::ValuesIn(spin_systems), test::name_of);

std::string error_of_spin(const std::string& main, const std::string& executor = "") {
  const std::string text =
      "services: {lookup: {server: map, clients: [robot]}}\nexecutors: {main: {kind: single" +
      executor + ", main: \"" + main +
      "\"}}\nnodes:\n  map: {callbacks: {find: {serves: lookup, do: \"lookup.answer;\"}}}\n"
      "  robot: {executor: main, callbacks: {go: {timer: 5, do: \"skip;\"}}}\n";
  return test::error_of([&] { parse_system(text, "s.yaml", test::test_model); });
}

// What spins may lock, too.
TEST(Spins, MainUsesLocks) {
  const std::string text =
      "models: {m: {use: mutex, with: {recursive: true}}, cv: {use: condition, with: {mutex: m}}}\n"
      "executors: {main: {kind: single, main: \"m.lock; cv.wait timeout 5 { } m.unlock; spin "
      "once;\"}}\n"
      "nodes: {n: {executor: main, callbacks: {tick: {timer: 5, do: \"cv.notify_all;\"}}}}\n";
  const System system = parse_system(text, "s.yaml", test::test_model);
  NativeEngine engine;
  EXPECT_EQ(check_system(system, engine, {}).verdict, Verdict::holds);
}

TEST(Spins, SlipsAreNamedWithTheirPlace) {
  EXPECT_EQ(test::error_of([&] {
              parse_system(
                  "executors: {e: {kind: multi, threads: 2}}\nnodes: {n: {executor: e, "
                  "start: \"spin some;\", callbacks: {t: {timer: 5, do: \"skip;\"}}}}\n",
                  "s.yaml", test::test_model);
            }),
            "a 'start' that spins goes with one thread yet: for several it is not built "
            "(s.yaml:2:34)");
  EXPECT_EQ(error_of_spin("spin other;"),
            "'spin' runs the executor of its 'main', and in a 'start' its node alone; 'other' from "
            "elsewhere is not built (s.yaml:2:46)");
  EXPECT_EQ(error_of_spin("spin main; spin once main; spin some main 3; spin all (1 + 1);"), "");
  EXPECT_EQ(test::error_of([&] {
              parse_system(
                  "constants: {k: 2}\nexecutors: {e: {kind: single, main: \"spin some k; "
                  "spin all e k;\"}}\nnodes: {n: {executor: e, callbacks: {t: {timer: 5, "
                  "do: \"skip;\"}}}}\n",
                  "s.yaml", test::test_model);
            }),
            "");
  EXPECT_EQ(error_of_spin("spin some 0;"), "'spin' runs from 1 to 100 callbacks (s.yaml:2:51)");
  EXPECT_EQ(error_of_spin("spin until lookup -> request;"),
            "'spin until' waits for the answer of a service (s.yaml:2:52)");
  EXPECT_EQ(error_of_spin("spin once;", ", order: rounds"),
            "with 'order: rounds', 'spin once' and 'spin until' are not built (s.yaml:2:56)");
  EXPECT_EQ(error_of_spin("spin some timeout 5 { }"),
            "expected ';' at the end of the statement, not '5' (s.yaml:2:59)");
  EXPECT_EQ(
      test::error_of([&] { parse_system("programs: {p: \"spin;\"}", "s.yaml", test::test_model); }),
      "'spin' stands in 'main' of an executor, or in the code of a node (s.yaml:1:16)");
}

}  // namespace
}  // namespace maide
