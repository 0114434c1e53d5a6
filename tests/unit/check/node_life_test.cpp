// How nodes begin and end, and what runs beside their executors: constructors, services that come
// and go, timers that come once or go by a clock, threads, deaths. Five of the systems are programs
// that hung on rclcpp (Humble), each beside one that does not.
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

// Two constructors, each of which waits for the other's service.
std::string constructors(const std::string& of_a, const std::string& of_b) {
  return R"yaml(
services:
  svc_a: {server: a, clients: [b], with: {depth: 1}}
  svc_b: {server: b, clients: [a], with: {depth: 1}}
nodes:
  a: {start: ")yaml" +
         of_a + R"yaml(", callbacks: {serve: {serves: svc_a, do: "svc_a.answer;"}}}
  b: {start: ")yaml" +
         of_b + R"yaml(", callbacks: {serve: {serves: svc_b, do: "svc_b.answer;"}}}
properties: {up: {possible: "svc_a.there && svc_b.there"}, late: {possible: "a.start@up"}}
)yaml";
}

// A callback waits for a server that another callback makes, on one executor or two.
std::string server_in_callback(const std::string& executors) {
  return R"yaml(
topics:
  goal: {writers: w1, readers: robot, use: queue, with: {depth: 1}}
  map: {writers: w2, readers: maps, use: queue, with: {depth: 1}}
services:
  lookup: {server: maps, clients: [robot]}
programs: {w1: "goal.write;", w2: "map.write;"}
)yaml" + executors +
         R"yaml(
    clients: {lookup: {do: "@answered skip;"}}
    callbacks: {on_goal: {takes: goal.read, do: "wait lookup -> there; lookup.send;"}}
  maps:
    executor: main
    callbacks:
      on_map: {takes: map.read, do: "offer lookup;"}
      find: {serves: lookup, do: "lookup.answer;"}
properties: {answered: "F robot@answered"}
)yaml";
}
const std::string one_executor =
    "executors: {main: {kind: single}}\nnodes:\n  robot:\n    executor: main";
const std::string two_executors =
    "executors: {main: {kind: single}, other: {kind: single}}\nnodes:\n  robot:\n    executor: "
    "other";

// A callback joins a thread whose answer its own thread would hand over, or does not.
std::string thread(const std::string& threads, const std::string& code) {
  return R"yaml(
topics:
  goal: {writers: world, readers: robot, use: queue, with: {depth: 2}}
services:
  lookup: {server: map, clients: [robot], with: {depth: 2}}
programs: {world: "repeat 2 { goal.write; }"}
nodes:
  robot:
    variables: "var done: 0..2;"
    threads: {work: )yaml" +
         threads + R"yaml(}
    callbacks: {on_goal: {takes: goal.read, do: ")yaml" +
         code + R"yaml("}}
  map: {callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}
properties: {done: "F robot.done == 2"}
)yaml";
}
const std::string asks = "\"lookup.send; wait lookup -> answer; atomic { done = done + 1; }\"";

// The server's process dies.
std::string dying_server(const std::string& wait, const std::string& property = "") {
  return R"yaml(
services:
  lookup: {server: map, clients: [robot], with: {depth: 1}}
executors: {em: {kind: single, may_die: true}, main: {kind: multi, threads: 2}}
nodes:
  map: {executor: em, callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}
  robot:
    executor: main
    groups: {g: exclusive}
    clients: {lookup: g}
    callbacks: {tick: {timer: once 100, do: "@ask lookup.send; )yaml" +
         wait + R"yaml( @got skip;"}}
properties:
  got: "G (robot@ask -> F robot@got)"
)yaml" + property;
}

// A controller goes by a clock that somebody moves.
std::string clock(const std::string& step) {
  return R"yaml(
topics:
  cmd: {writers: controller, readers: simulator, use: queue, with: {depth: 1}}
  clock: {writers: simulator, use: queue, with: {depth: 1}}
executors: {main: {kind: single}}
nodes:
  controller: {executor: main, clock: clock, callbacks: {tick: {timer: 33, do: "cmd.write;"}}}
  simulator:
    executor: main
    variables: "var steps: 0..3;"
    callbacks: {)yaml" +
         step + R"yaml(}
properties:
  runs: {ltl: "F simulator.steps == 3", fairness: strong}
  commands: {ltl: "G F cmd.write", fairness: strong}
)yaml";
}

// A timer that comes once, and one that another callback turns on and off.
std::string timers(const std::string& executor) {
  return "executors: {main: " + executor + R"yaml(}
nodes:
  n:
    executor: main
    variables: "var going: bool; var count: 0..2;"
    callbacks:
      go: {timer: once 10, do: "going = true;"}
      work: {timer: 10, when: "going && count < 2", do: "count = count + 1;"}
      end: {timer: 10, when: "count == 2", do: "going = false;"}
properties:
  early: "!F (!n.going && n.count == 1)"
  again: "!F (!n.going && n.count == 2 && F n.going)"
  done: {ltl: "F (n.count == 2 && !n.going)", fairness: strong}
)yaml";
}

// A thread that a procedure begins, and that publishes.
const std::string publishes = R"yaml(
topics:
  found: {writers: robot, readers: world, use: queue, with: {depth: 2}}
procedures: {"begin()": "run work;"}
programs: {world: "repeat 2 { found.read -> message; } @both skip;"}
nodes:
  robot:
    threads: {work: {count: 2, do: "found.write;"}}
    callbacks: {go: {timer: once 10, do: "call begin(); call begin();"}}
properties: {both: {ltl: "F world@both", fairness: strong}}
)yaml";

// What is written behind these statements comes to queues, too.
const std::string values_behind = R"yaml(
models: {q: {use: queue, with: {size: 3}}}
services:
  lookup: {server: n, clients: [c]}
programs:
  c: "wait lookup -> there; q.read -> message(var x); q.read -> message(var y); @sum skip;"
nodes:
  n:
    threads: {work: "q.write(4);"}
    start: "offer lookup; withdraw lookup; offer lookup; run work; join work; q.write(5);"
    callbacks: {find: {serves: lookup, do: "lookup.answer;"}}
properties: {sum: "F (c@sum && c.x + c.y == 9)"}
)yaml";

// Each member of an array offers a service of its own, and has a thread.
const std::string arrays = R"yaml(
services:
  lookup[i in 0..1]: {server: "map[i]", clients: ["robot[i]"], with: {depth: 1}}
nodes:
  map[i in 0..1]:
    start: "offer lookup[i];"
    callbacks: {find: {serves: "lookup[i]", do: "lookup[i].answer;"}}
  robot[i in 0..1]:
    threads:
      work: "wait lookup[i] -> there; lookup[i].send; wait lookup[i] -> answer; @got skip;"
    callbacks: {go: {timer: once 1, do: "run work;"}}
properties: {got: {ltl: "F robot[1]@got", fairness: strong}, there: "F lookup[0].there"}
)yaml";

// Two timers that come once and wait for each other, in one group.
std::string two_timers(const std::string& group) {
  return R"yaml(
executors: {main: {kind: multi, threads: 2}}
nodes:
  n:
    executor: main
    groups: {g: )yaml" +
         group + R"yaml(}
    variables: "var a: bool; var b: bool;"
    callbacks:
      one: {timer: once 10, group: g, do: "a = true; select { when (b) { } }"}
      two: {timer: once 10, group: g, do: "b = true; select { when (a) { } }"}
)yaml";
}

// A condition that is an error where it is looked at.
const std::string error_in_when = R"yaml(
executors: {main: {kind: single, order: rounds}}
nodes:
  n:
    executor: main
    variables: "var x: 0..2; var list[i in 0..1]: bool;"
    callbacks:
      count: {timer: 10, when: "x < 2", do: "x = x + 1;"}
      look: {timer: 10, when: "list[x]", do: "skip;"}
)yaml";

const test::VerdictCase node_systems[] = {
    {"constructors_wait", "deadlock", V,
     constructors("wait svc_b -> there; offer svc_a; @up skip;",
                  "wait svc_a -> there; offer svc_b;")},
    {"constructors_wait", "up", V,
     constructors("wait svc_b -> there; offer svc_a; @up skip;",
                  "wait svc_a -> there; offer svc_b;")},
    {"constructors_offer", "deadlock", H,
     constructors("offer svc_a; wait svc_b -> there; @up skip;",
                  "wait svc_a -> there; offer svc_b;")},
    {"constructors_offer", "late", H,
     constructors("offer svc_a; wait svc_b -> there; @up skip;",
                  "wait svc_a -> there; offer svc_b;")},
    {"answer_in_start", "deadlock", V,
     constructors("offer svc_a; wait svc_b -> there; svc_b.send; wait svc_b -> answer; @up skip;",
                  "offer svc_b;")},
    {"withdrawn", "deadlock", V,
     constructors("offer svc_a; withdraw svc_a; @up skip;", "wait svc_a -> there; offer svc_b;")},
    {"server_in_callback_one", "deadlock", V, server_in_callback(one_executor)},
    {"server_in_callback_two", "deadlock", H, server_in_callback(two_executors)},
    {"server_in_callback_two", "answered", H, server_in_callback(two_executors)},
    {"thread_is_joined", "deadlock", V, thread(asks, "run work; join work;")},
    {"thread_is_left", "deadlock", H, thread("{count: 2, do: " + asks + "}", "run work;")},
    {"thread_is_left", "done", H, thread("{count: 2, do: " + asks + "}", "run work;")},
    {"thread_is_taken", "error", V, thread(asks, "run work;")},
    {"thread_begins_itself", "done", H, thread("\"done = 2;\"", "skip;")},
    {"server_dies", "deadlock", V, dying_server("wait lookup -> answer;")},
    {"server_dies", "got", V, dying_server("wait lookup -> answer;")},
    {"server_dies_timeout", "got", H,
     dying_server("select { on lookup!answer { } timeout 5 { } }")},
    {"server_dies_noticed", "deadlock", H,
     dying_server("select { on lookup!answer { } when (!lookup.there) { @gone skip; } }")},
    {"server_dies_noticed", "got", H,
     dying_server("select { on lookup!answer { } when (!lookup.there) { @gone skip; } }")},
    {"server_dies_noticed", "known", H,
     dying_server("select { on lookup!answer { } when (!lookup.there) { @gone skip; } }",
                  "  known: \"G (robot@gone -> !lookup.there)\"\n")},
    {"clock_stands", "runs", V,
     clock(
         R"yaml(on_cmd: {takes: cmd.read, do: "if (steps < 3) { steps = steps + 1; } clock.write;"})yaml")},
    {"clock_goes", "runs", H, clock(R"yaml(on_cmd: {takes: cmd.read, do: "skip;"},
              step: {timer: 5, do: "if (steps < 3) { steps = steps + 1; } clock.write;"})yaml")},
    {"clock_goes", "commands", H, clock(R"yaml(on_cmd: {takes: cmd.read, do: "skip;"},
              step: {timer: 5, do: "if (steps < 3) { steps = steps + 1; } clock.write;"})yaml")},
    {"timers", "early", H, timers("{kind: single}")},
    {"timers", "again", H, timers("{kind: single}")},
    {"timers", "done", H, timers("{kind: single}")},
    {"timers_by_rounds", "early", H, timers("{kind: single, order: rounds}")},
    {"timers_by_rounds", "done", H, timers("{kind: single, order: rounds}")},
    {"thread_publishes", "both", H, publishes},
    {"values_behind", "sum", H, values_behind},
    {"arrays", "got", H, arrays},
    {"arrays", "there", H, arrays},
    {"thread_publishes", "deadlock", H, publishes},
    {"once_in_exclusive_group", "deadlock", V, two_timers("exclusive")},
    {"once_in_reentrant_group", "deadlock", H, two_timers("reentrant")},
    {"when_is_an_error", "error", V, error_in_when},
    {"only_a_thread", "done", H,
     "executors: {main: {kind: single, order: rounds}}\nnodes:\n  n: {executor: main, variables: "
     "\"var x: 0..1;\", threads: {work: \"x = 1;\"}}\nproperties: {done: \"F n.x == 1\"}\n"},
    {"timers_on_two", "done", H, timers("{kind: multi, threads: 2}")},
};

class NodeSystems : public testing::TestWithParam<test::VerdictCase> {};

TEST_P(NodeSystems, HaveTheVerdictsThatTheyMustHave) { test::expect_verdict(GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, NodeSystems, testing::ValuesIn(node_systems), test::name_of);

std::string error_in(const std::string& robot) {
  const std::string text = R"yaml(
services:
  lookup: {server: map, clients: [robot]}
nodes:
  map: {callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}
  robot: )yaml" + robot + "\n";
  return test::error_of([&] { parse_system(text, "s.yaml", test::test_model); });
}

TEST(NodeLife, SlipsAreNamedWithTheirPlace) {
  EXPECT_EQ(error_in("{start: \"offer lookup;\"}"),
            "'offer' stands in the code of the service's server (s.yaml:6:19)");
  EXPECT_EQ(error_in("{start: \"run work;\"}"), "node robot has no thread 'work' (s.yaml:6:23)");
  EXPECT_EQ(error_in("{threads: {work: \"skip;\"}, start: \"join wrok;\"}"),
            "node robot has no thread 'wrok'; it has: work; did you mean 'work'? (s.yaml:6:50)");
  EXPECT_EQ(error_in("{threads: {work: {count: 9, do: \"skip;\"}}}"),
            "'count' goes from 1 to 4 (s.yaml:6:35)");
  EXPECT_EQ(error_in("{callbacks: {start: {timer: 1, do: \"skip;\"}}, start: \"skip;\"}"),
            "node robot has a callback 'start', too: call it otherwise (s.yaml:6:56)");
  EXPECT_EQ(error_in("{callbacks: {tick: {timer: once, do: \"skip;\"}}}"),
            "expected an expression, not the end of the text (s.yaml:6:41)");
  EXPECT_EQ(error_in("{callbacks: {tick: {timer: 1, when: \"robot.there\", do: \"skip;\"}}}"),
            "'robot.there' asks whether a service is there, and 'robot' is none (s.yaml:6:47)");
}

TEST(NodeLife, AClockKeepsTheLastMessage) {
  const std::string text = R"yaml(
topics: {clock: {writers: w, use: queue, with: {size: 1}}}
programs: {w: "clock.write;"}
nodes: {n: {clock: clock, callbacks: {tick: {timer: 1, do: "skip;"}}}}
)yaml";
  EXPECT_EQ(test::error_of([&] { parse_system(text, "s.yaml", test::test_model); }),
            "a clock is a topic with `use: queue` and `depth` (s.yaml:4:20)");
}

// What nobody says costs no state: a service that is there from the begin has no variable.
TEST(NodeLife, AServiceThatIsThereCostsNothing) {
  const std::string text = R"yaml(
services:
  lookup: {server: map, clients: [robot]}
programs:
  map: "loop { idle lookup.serve -> request; lookup.answer; }"
  robot: "wait lookup -> there; lookup.send; lookup.receive -> answer;"
)yaml";
  const System system = parse_system(text, "s.yaml", test::test_model);
  for (const ModelInstance& model : system.models) {
    EXPECT_NE(model.source, ModelInstance::Source::variable) << model.name;
  }
}

}  // namespace
}  // namespace maide
