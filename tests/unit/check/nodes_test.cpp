// Services, executors and nodes. Which calls inside of a callback hang, and what ten strangers'
// answers do, is what rclcpp (Humble) was measured to do. Random systems are held against an
// interpreter of its own in tests/referee.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;
using testing::Not;

System nodes_from(const std::string& text) {
  return parse_system(text, "s.yaml", test::test_model);
}

CheckReport check_nodes(const System& system, Reduction reduction = Reduction::full,
                        std::vector<std::string> properties = {}) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = std::move(properties);
  request.options.reduction = reduction;
  return check_system(system, engine, request);
}

// The verdict of that property, which all reductions agree on.
std::string verdict(const std::string& text, const std::string& property) {
  const System system = nodes_from(text);
  std::string common;
  for (const Reduction reduction : {Reduction::none, Reduction::order, Reduction::full}) {
    const CheckReport report = check_nodes(system, reduction, {property});
    const auto found =
        std::find_if(report.properties.begin(), report.properties.end(),
                     [&](const PropertyResult& result) { return result.name == property; });
    if (found == report.properties.end()) return "no such property";
    const std::string verdict = to_string(found->verdict);
    if (!common.empty() && common != verdict) return common + ", and " + verdict;
    common = verdict;
  }
  return common;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? "'" + what + "' is not there"
                                 : text.replace(at, what.size(), by);
}

// ---- a call inside of a callback ----------------------------------------------------------------

const std::string ask = "takes: image.read, do: \"lookup.send; wait lookup -> answer;\"";
const std::string own = "callbacks: {on_image: {" + ask + "}}";

// Two images, for each of which the node's callback asks and waits.
std::string nested_system(const std::string& executor, const std::string& node) {
  return "services: {lookup: {server: database, clients: [detector]}}\n"
         "topics: {image: {writers: camera, readers: detector, use: queue, with: {size: 2}}}\n"
         "programs:\n"
         "  camera: \"repeat 2 { image.write; }\"\n"
         "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
         "executors: {main: " +
         executor + "}\n" + "nodes:\n  detector: {executor: main, " + node + "}\n";
}

// Where callers, client and server are: groups of one node, "a", "b", "c" exclusive and "r" not;
// no group of the server: it is elsewhere.
struct Groups {
  std::string name, caller, client, server;
  // Whether one call hangs, and whether one of two at once does: on a single-threaded executor, and
  // on one of 1, 2 and 4 threads.
  std::string one, two;
};

void PrintTo(const Groups& groups, std::ostream* out) { *out << groups.name; }

std::string nested_call(const Groups& groups, const std::string& executor, int callers) {
  std::string topics, callbacks, writes;
  for (int caller = 1; caller <= callers; ++caller) {
    const std::string topic = "t" + std::to_string(caller);
    topics += "  " + topic + ": {writers: world, readers: n, use: queue, with: {size: 1}}\n";
    writes += topic + ".write; ";
    callbacks += "      call" + std::to_string(caller) + ": {takes: " + topic +
                 ".read, group: " + groups.caller + ", do: \"s.send; wait s -> answer;\"}\n";
  }
  std::string programs = "  world: \"" + writes + "\"\n", server = "n";
  if (groups.server.empty()) {
    server = "server";
    programs += "  server: \"loop { idle s.serve -> request; s.answer; }\"\n";
  } else {
    callbacks += "      serve: {serves: s, group: " + groups.server + ", do: \"s.answer;\"}\n";
  }
  return "services: {s: {server: " + server + ", clients: n, with: {depth: 2}}}\ntopics:\n" +
         topics + "programs:\n" + programs + "executors: {e: " + executor + "}\nnodes:\n  n:\n" +
         "    executor: e\n    groups: {a: exclusive, b: exclusive, c: exclusive, r: reentrant}\n" +
         "    clients: {s: " + groups.client + "}\n    callbacks:\n" + callbacks;
}

class NestedCalls : public testing::TestWithParam<Groups> {};

TEST_P(NestedCalls, HangAsMeasured) {
  const std::vector<std::string> executors = {"{kind: single}", "{kind: multi, threads: 1}",
                                              "{kind: multi, threads: 2}",
                                              "{kind: multi, threads: 4}"};
  for (const int callers : {1, 2}) {
    const std::string& measured = callers == 1 ? GetParam().one : GetParam().two;
    for (std::size_t i = 0; i < executors.size(); ++i) {
      const std::string expected = measured[i] == 'h' ? "violated" : "holds";
      EXPECT_EQ(verdict(nested_call(GetParam(), executors[i], callers), "deadlock"), expected)
          << callers << " on " << executors[i];
    }
    EXPECT_EQ(
        verdict(nested_call(GetParam(), "{kind: single, order: rounds}", callers), "deadlock"),
        measured[0] == 'h' ? "violated" : "holds");
  }
}

// docs/middleware/ros2.md, Which calls hang: 'h' hangs, 'r' returns.
INSTANTIATE_TEST_SUITE_P(
    Rclcpp, NestedCalls,
    testing::Values(Groups{"AllInOneExclusiveGroup", "a", "a", "a", "hhhh", "hhhh"},
                    Groups{"CallerAndClientInOneGroup", "a", "a", "", "hhhh", "hhhh"},
                    Groups{"ClientAlone", "a", "b", "", "hhrr", "hhrr"},
                    Groups{"ClientAloneServerWithCaller", "a", "b", "a", "hhhh", "hhhh"},
                    Groups{"ClientAloneServerWithClient", "a", "b", "b", "hhrr", "hhrr"},
                    Groups{"ThreeExclusiveGroups", "a", "b", "c", "hhrr", "hhrr"},
                    Groups{"AllReentrant", "r", "r", "r", "hhrr", "hhhr"},
                    Groups{"CallerAndClientReentrant", "r", "r", "", "hhrr", "hhhr"}),
    [](const auto& test) { return test.param.name; });

// ---- services -----------------------------------------------------------------------------------

const std::string strangers =
    "services: {lookup: {server: database, clients: [planner, monitor], with: {depth: 10}}}\n"
    "programs:\n"
    "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
    "  planner: \"lookup.send; lookup.receive -> answer;\"\n"
    "  monitor: \"repeat 10 { lookup.send; lookup.receive -> answer; }\"\n";

TEST(Services, TenStrangersAnswersPushOutOne) {
  EXPECT_EQ(verdict(strangers, "deadlock"), "violated");
  EXPECT_EQ(verdict(replaced(strangers, "repeat 10", "repeat 9"), "deadlock"), "holds");
}

TEST(Services, KeepTheLastRequests) {
  const std::string text =
      "services: {s: {server: a, clients: b, with: {depth: 2}}}\n"
      "programs:\n"
      "  a: \"var n: 0..9; loop { @n idle s.serve -> request; n = n + 1; s.answer; }\"\n"
      "  b: \"repeat 3 { s.send; }\"\n"
      "properties: {three: \"F a.n == 3\", two: \"F a.n >= 1\", most: \"G a.n <= 3\"}\n";
  EXPECT_EQ(verdict(text, "three"), "violated");  // two of three sent at once are kept
  EXPECT_EQ(verdict(text, "two"), "holds");
  EXPECT_EQ(verdict(text, "most"), "holds");
}

// Each of three clients keeps its own answer and some of others behind it: those before it count
// for nothing, so there are some thousand states.
TEST(Services, ThreeClientsOfTheDefaultDepthAreCheckedWhole) {
  const System system = nodes_from(
      "services: {s: {server: d, clients: [a, b, c], delivery: at_once}}\n"
      "programs:\n"
      "  d: \"loop { idle s.serve -> request; s.answer; }\"\n"
      "  a: \"loop { s.send; s.receive -> answer; }\"\n"
      "  b: \"loop { s.send; s.receive -> answer; }\"\n"
      "  c: \"loop { s.send; s.receive -> answer; }\"\n");
  const CheckReport report = check_nodes(system, Reduction::none, {"deadlock", "stuck"});
  EXPECT_EQ(report.properties[0].verdict, Verdict::holds);
  EXPECT_EQ(report.properties[1].verdict, Verdict::violated);  // ten strangers' answers
}

// One client of depth 1: requests kept or not, one served or not, an answer kept or not, before and
// behind each of `serve` and `receive` that wait.
TEST(Services, OneClientIsCounted) {
  const System system = nodes_from(
      "services: {s: {server: a, clients: b, with: {depth: 1}, delivery: at_once}}\n"
      "programs:\n"
      "  a: \"loop { select { on s.serve -> request { } on s.answer { } } }\"\n"
      "  b: \"loop { select { on s.send { } on s.receive -> answer { } } }\"\n");
  EXPECT_EQ(check_nodes(system, Reduction::none).components.front().states, 17u);
}

// ---- executors ----------------------------------------------------------------------------------

const std::string counters =
    "models: {go: {use: semaphore, with: {count: 2}}}\n"
    "executors: {main: {kind: multi, threads: 2}}\n"
    "nodes:\n"
    "  robot:\n"
    "    executor: main\n"
    "    groups: {r: reentrant}\n"
    "    variables: \"var n: 0..2; var ended: 0..2;\"\n"
    "    callbacks:\n"
    "      on_go: {takes: go.acquire, group: r, do: \"var x: 0..2; x = n; n = x + 1; atomic { "
    "ended = ended + 1; }\"}\n"
    "properties: {both: \"G (robot.ended == 2 -> robot.n == 2)\"}\n";

TEST(Executors, TwoRunsOfAReentrantCallbackLoseAnUpdate) {
  EXPECT_EQ(verdict(counters, "both"), "violated");
  EXPECT_EQ(verdict(replaced(counters, "r: reentrant", "r: exclusive"), "both"), "holds");
  EXPECT_EQ(verdict(replaced(counters, "kind: multi, threads: 2", "kind: single"), "both"),
            "holds");
}

const std::string two_subscriptions =
    "topics:\n"
    "  a: {writers: w, readers: n, use: queue, with: {size: 1}, delivery: at_once}\n"
    "  b: {writers: w, readers: n, use: queue, with: {size: 1}, delivery: at_once}\n"
    "programs: {w: \"a.write; b.write; @both a.write; a.write;\"}\n"
    "executors: {main: {kind: single, order: rounds}}\n"
    "nodes:\n"
    "  n:\n"
    "    executor: main\n"
    "    callbacks: {on_a: {takes: a.read, do: \"@a skip;\"}, on_b: {takes: b.read, do: \"@b "
    "skip;\"}}\n"
    // `a` does not come three times before b.
    "properties: {old: \"G (w@both -> !(!n@b U (n.on_a@a & (n.on_a@a U (!n.on_a@a & (!n@b U "
    "(n.on_a@a "
    "& (n.on_a@a U (!n.on_a@a & (!n@b U n.on_a@a))))))))))\"}\n";

// A look may have found `a` alone; the next finds both, and then it is b's turn, whatever came.
TEST(Executors, WhatALookFoundGoesFirst) {
  EXPECT_EQ(verdict(two_subscriptions, "old"), "holds");
  EXPECT_EQ(verdict(replaced(two_subscriptions, "order: rounds", "order: any"), "old"), "violated");
}

// The first callback takes what the look found for both.
TEST(Executors, WhatALookFoundMayBeGone) {
  const std::string one_unit =
      "models: {go: {use: semaphore, with: {count: 1}}}\n"
      "executors: {main: {kind: single, order: rounds}}\n"
      "nodes:\n"
      "  n:\n"
      "    executor: main\n"
      "    callbacks: {a: {takes: go.acquire, do: \"skip;\"}, b: {takes: go.acquire, do: "
      "\"skip;\"}}\n";
  for (const char* property : {"deadlock", "stuck"}) {
    EXPECT_EQ(verdict(one_unit, property), "holds");
    EXPECT_EQ(verdict(replaced(one_unit, "order: rounds", "order: any"), property), "holds");
  }
}

// Two nodes on one thread are one program, and still two nodes.
TEST(Nodes, WriteOnlyWhereTheyAreWriters) {
  const std::string text =
      "topics: {image: {writers: camera, readers: detector, use: queue, with: {depth: 1}}}\n"
      "executors: {main: {kind: single}}\n"
      "nodes:\n"
      "  camera: {executor: main, callbacks: {tick: {timer: 1, do: \"image.write;\"}}}\n"
      "  detector: {executor: main, callbacks: {on_image: {takes: image.read, do: \"DO\"}}}\n";
  EXPECT_EQ(verdict(replaced(text, "DO", "skip;"), "deadlock"), "holds");
  try {
    nodes_from(replaced(text, "DO", "image.write;"));
    FAIL() << "is accepted";
  } catch (const ParseError& error) {
    EXPECT_THAT(error.what(), HasSubstr("this node is no writer of image"));
  }
}

// A node with two groups on two threads is one end, and the next one is the second.
TEST(Nodes, AreOneEndOfAModel) {
  InterfaceAutomaton line({"write", "write2"}, {}, 1);
  line.actors = {{"writer", {"write", "write2"}, {}}};
  line.add_transition(0, {Action::Kind::input, 0}, 0);
  line.add_transition(0, {Action::Kind::input, 1}, 0);
  const System system = parse_system(
      "models: {line: {file: two-writers.dot, ends: {writer: [robot, desk]}}}\n"
      "programs: {desk: \"line.write;\"}\n"
      "executors: {main: {kind: multi, threads: 2}}\n"
      "nodes:\n"
      "  robot:\n"
      "    executor: main\n"
      "    groups: {other: exclusive}\n"
      "    callbacks:\n"
      "      tick: {timer: 1, do: \"line.write;\"}\n"
      "      tock: {timer: 2, group: other, do: \"line.write;\"}\n",
      "s.yaml", [&](const ModelRequest&) { return line; });
  std::vector<std::string> inputs;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& event : program.events_of(edge)) {
        const ModelInstance& model = system.models[event.model];
        if (model.name != "line") continue;
        inputs.push_back(program.name + " " + model.automaton.inputs().name(event.index));
      }
    }
  }
  EXPECT_THAT(inputs,
              testing::UnorderedElementsAre("robot write", "robot.other write", "desk write2"));
}

// The second reader's callback takes what comes at its own end.
TEST(Nodes, TakeAtTheirOwnEnd) {
  InterfaceAutomaton line({"write", "read", "read2"}, {"message", "message2"}, 1);
  line.actors = {{"writer", {"write"}, {}}, {"reader", {"read", "read2"}, {"message", "message2"}}};
  const StateId full = line.add_state();
  line.add_transition(0, {Action::Kind::input, 0}, full);
  for (Symbol reader : {0U, 1U}) {
    const StateId due = line.add_state();
    line.add_transition(full, {Action::Kind::input, reader + 1}, due);
    line.add_transition(due, {Action::Kind::output, reader}, 0);
  }
  const System system = parse_system(
      "models: {o: {file: two.dot, ends: {reader: [a, b]}}}\n"
      "programs: {w: \"o.write;\"}\n"
      "nodes:\n"
      "  a: {callbacks: {on_o: {takes: o.read, do: \"skip;\"}}}\n"
      "  b: {callbacks: {on_o: {takes: o.read, do: \"skip;\"}}}\n"
      "properties: {second: \"G !o!message2\"}\n",
      "s.yaml", [&](const ModelRequest&) { return line; });
  EXPECT_EQ(check_nodes(system, Reduction::none, {"second"}).properties.front().verdict,
            Verdict::violated);
}

TEST(Nodes, TheSlipIsNamedAndNotWhatFollowsFromIt) {
  const std::string text =
      "topics: {t: {writers: w, readers: n, use: queue, with: {size: 1}}}\n"
      "programs: {w: \"t.write(1);\"}\n"
      "nodes:\n"
      "  n:\n"
      "    variables: \"var last: 0..1;\"\n"
      "    callbacks: {c: {takes: \"t.read -> message(last)\", do: \"if (last == 1) { skip } "
      "skip;\"}}\n";
  EXPECT_THAT(test::error_of([&] { nodes_from(text); }), HasSubstr("expected ';'"));
  EXPECT_EQ(verdict(replaced(text, "skip }", "skip; }"), "deadlock"), "holds");
}

TEST(Executors, WhatVerdictsRestOnIsSaid) {
  const auto says = [](const std::string& text, const std::string& what) {
    const CheckReport report = check_nodes(nodes_from(text));
    return std::any_of(
        report.assumptions.begin(), report.assumptions.end(),
        [&](const std::string& line) { return line.find(what) != std::string::npos; });
  };
  const std::string any = nested_system("{kind: single}", own);
  EXPECT_TRUE(says(any, "the callbacks of detector run on one thread, in any order"));
  EXPECT_TRUE(says(any, "lookup goes by the rules of services"));
  EXPECT_TRUE(says(any, "database uses lookup without executors"));
  EXPECT_FALSE(says(any, "a timer may be due at any moment"));
  EXPECT_TRUE(says("nodes: {camera: {callbacks: {tick: {timer: 33, do: \"skip;\"}}}}\n",
                   "a timer may be due at any moment"));
  EXPECT_TRUE(says(any, "nodes begin when all ends know each other"));
  EXPECT_FALSE(says("nodes: {camera: {callbacks: {tick: {timer: 33, do: \"skip;\"}}}}\n",
                    "nodes begin when all ends know each other"));
  // Groups come in the file's order, and rclcpp's is another one.
  EXPECT_FALSE(says(two_subscriptions, "that of addresses"));
  EXPECT_TRUE(
      says(replaced(replaced(two_subscriptions, "{takes: b.read,", "{takes: b.read, group: other,"),
                    "executor: main\n", "executor: main\n    groups: {other: exclusive}\n"),
           "main: callbacks of one kind in several groups or nodes come in the file's order; "
           "rclcpp's is that of addresses"));
}

// Plain programs that use what has callbacks in reality; ends that come while the system runs.
TEST(Executors, WhatIsLearnedFromRos2IsSaidToBeWithoutThem) {
  const auto lines = [](const std::string& text, const std::string& sul) {
    const System system = parse_system(text, "s.yaml", [&](const ModelRequest& request) {
      if (!request.file.empty()) {
        ModelRequest local = request;
        local.file = std::string(MAIDE_SOURCE_DIR) + "/examples/ros2/late-server/server.dot";
        return read_requested_model(local);
      }
      InterfaceAutomaton model = make_queue({1, true, {}, sul.empty()});
      if (!sul.empty()) model.origin = {{"sul", sul}};
      return model;
    });
    return fmt::format("{}", fmt::join(check_nodes(system).assumptions, "\n"));
  };
  const std::string topic =
      "models: {image: {learn: ros2, with: {depth: unknown}}}\n"
      "programs: {camera: \"image.write;\", planner: \"image.read -> message;\"}\n";
  const std::string without = "camera, planner use image without executors";
  const std::string learned = lines(topic, "ros2 kind=topic rmw=fastrtps");
  EXPECT_THAT(learned, HasSubstr(without));
  EXPECT_THAT(learned, HasSubstr("image was learned from rclcpp over fastrtps"));
  EXPECT_THAT(learned, Not(HasSubstr("an end that comes")));
  EXPECT_THAT(lines(topic, ""), HasSubstr(without));  // a queue of unknown depth

  const std::string client =
      "models: {lookup: {file: server.dot}}\n"
      "programs: {client: \"lookup.send;\", server: \"";
  const std::string comes = "lookup: an end that comes is there when both sides know it";
  EXPECT_THAT(lines(client + "lookup.start;\"}\n", ""), HasSubstr(comes));
  EXPECT_THAT(lines(client + "skip;\"}\n", ""), Not(HasSubstr(comes)));
}

// The server writes to `a` before it answers the node, which asks when the other client has its
// answer.
const std::string answered_before =
    "topics:\n"
    "  go: {writers: other, readers: n.on_go, use: queue, with: {size: 1}}\n"
    "  a: {writers: server, readers: n.on_a, use: queue, with: {size: 1}, delivery: at_once}\n"
    "services: {s: {server: server, clients: [n, other], with: {depth: 2, rmw: cyclonedds}, "
    "delivery: at_once}}\n"
    "programs:\n"
    "  other: \"s.send; s.receive -> answer; go.write;\"\n"
    "  server: \"s.serve -> request; s.answer; s.serve -> request; a.write; s.answer;\"\n"
    "executors: {main: {kind: single, order: rounds}}\n"
    "nodes:\n"
    "  n:\n"
    "    executor: main\n"
    "    clients: {s: {do: \"answered = true;\"}}\n"
    "    variables: \"var came: bool; var answered: bool;\"\n"
    "    callbacks: {on_go: {takes: go.read, do: \"s.send;\"}, on_a: {takes: a.read, do: \"came = "
    "true;\"}}\n"
    "properties: {order: {always: \"n.answered -> n.came\"}}\n";

// A look finds the node's client by the other's answer, before anything is written to `a`. In its
// turn the client takes its own answer, too, over Cyclone DDS; over Fast DDS only if that has
// pushed out the other's.
TEST(Executors, ALookFindsAClientByAnswersToOthers) {
  const auto with = [](const std::string& options) {
    return replaced(answered_before, "{depth: 2, rmw: cyclonedds}", options);
  };
  EXPECT_EQ(verdict(answered_before, "order"), "violated");
  EXPECT_EQ(verdict(with("{depth: 2}"), "order"), "violated");
  EXPECT_EQ(verdict(with("{depth: 2, rmw: fastrtps}"), "order"), "holds");
  EXPECT_EQ(verdict(with("{depth: 1, rmw: fastrtps}"), "order"), "violated");
  for (const char* property : {"deadlock", "stuck"}) {
    EXPECT_EQ(verdict(answered_before, property), "holds");
    EXPECT_EQ(verdict(with("{depth: 2, rmw: fastrtps}"), property), "holds");
  }
}

// The map has arrived before the server answers. A look over Fast DDS asks for the map first: it
// may miss it, and find the answer, which came later.
TEST(Executors, ALookOverFastDdsAsksForOneAfterTheOther) {
  const std::string text =
      "topics: {map: {writers: server, readers: robot.on_map, use: queue, with: {depth: 1}, "
      "delivery: late}}\n"
      "services: {s: {server: server, clients: robot, with: {depth: 2, rmw: fastrtps}, delivery: "
      "late}}\n"
      "programs: {server: \"s.serve -> request; map.write; wait map -> arrived; s.answer;\"}\n"
      "executors: {main: {kind: single, order: rounds}}\n"
      "nodes:\n"
      "  robot:\n"
      "    executor: main\n"
      "    clients: {s: {do: \"if (!came) { @blind skip; } answered = true;\"}}\n"
      "    variables: \"var came: bool; var answered: bool; var asked: bool;\"\n"
      "    callbacks:\n"
      "      ask: {timer: 1, do: \"if (!asked) { asked = true; s.send; }\"}\n"
      "      on_map: {takes: map.read -> message, do: \"came = true;\"}\n"
      "properties:\n"
      "  there: \"G !robot@blind\"\n"
      "  answered: \"F robot.answered\"\n"
      "  came: \"F robot.came\"\n";
  EXPECT_EQ(verdict(text, "there"), "violated");
  EXPECT_EQ(verdict(text, "answered"), "holds");
  EXPECT_EQ(verdict(text, "came"), "holds");
  EXPECT_EQ(verdict(text, "deadlock"), "holds");
  EXPECT_EQ(verdict(text, "stuck"), "holds");
  EXPECT_EQ(verdict(replaced(text, "fastrtps", "cyclonedds"), "there"), "holds");
  // Where nothing is late it looks in one step.
  const auto at_once = [&](const std::string& rmw) {
    return nodes_from(
        replaced(replaced(replaced(text, "late", "at_once"), "late", "at_once"), "fastrtps", rmw));
  };
  const auto rounds_of = [](const System& system) {
    for (const Program& program : system.programs) {
      if (!program.nodes.empty()) return program.states.size();
    }
    return std::size_t{0};
  };
  EXPECT_EQ(rounds_of(at_once("fastrtps")), rounds_of(at_once("cyclonedds")));
  EXPECT_GT(rounds_of(nodes_from(text)),
            rounds_of(nodes_from(replaced(text, "fastrtps", "cyclonedds"))));
}

// The search for a shorter run does not know all edges of what lies far from the start.
TEST(Executors, ManyRunsOfACallbackHaveAFairCycle) {
  const System system = nodes_from(
      "executors: {e: {kind: multi, threads: 6}}\nmodels: {m: {use: mutex}}\n"
      "nodes: {n: {executor: e, groups: {g: reentrant}, callbacks: {"
      "t: {timer: 1, group: g, do: \"m.lock; m.unlock;\"}, "
      "u: {timer: 2, group: g, do: \"m.lock; @a m.unlock;\"}}}}\n"
      "properties: {p: \"G F n@a\"}\n");
  EXPECT_EQ(check_nodes(system, Reduction::none, {"p"}).properties.front().verdict,
            Verdict::violated);
}

TEST(Executors, CodeThatMayGoRoundForEverMakesStuckInconclusive) {
  const std::string text =
      "models: {m: {use: mutex}}\nnodes: {n: {callbacks: {t: {timer: 5, do: \"loop { m.lock; "
      "m.unlock; if * { return; } }\"}}}}\n";
  const auto result = [](const std::string& of, const std::string& property) {
    return check_nodes(nodes_from(of), Reduction::full, {property}).properties.front();
  };
  EXPECT_EQ(result(text, "stuck").verdict, Verdict::inconclusive);
  EXPECT_NE(result(text, "stuck").reason.find("may go round for ever at line 2"),
            std::string::npos);
  EXPECT_EQ(result(text, "deadlock").verdict, Verdict::holds);
  EXPECT_EQ(result(replaced(text, "loop {", "repeat 2 {"), "stuck").verdict, Verdict::holds);
  EXPECT_EQ(result(two_subscriptions, "stuck").verdict, Verdict::holds);  // a look is no code
}

// Both nodes are one program, with one text: what is fair of one is not of the other.
TEST(Executors, MembersOfAnArrayAreFairEachByItself) {
  const std::string text =
      "executors: {e: {kind: single}}\n"
      "models: {m: {use: mutex}, k: {use: mutex}}\n"
      "nodes:\n  \"n[i in 0..1]\":\n    executor: e\n    callbacks:\n"
      "      t: {timer: 1, do: \"@t if fair * { @yes m.lock; m.unlock; } else { k.lock; k.unlock; "
      "}\"}\n"
      "properties:\n"
      "  each: {ltl: \"G F n[0].t@yes & G F n[1].t@yes\", fairness: strong}\n"
      "  starts: {ltl: \"G F n[0].t@t & G F n[1].t@t\", fairness: strong}\n";
  EXPECT_EQ(verdict(text, "each"), "holds");
  EXPECT_EQ(verdict(text, "starts"), "holds");
}

// What a look finds is fair: each timer is due again and again, alone and with the other.
TEST(Executors, InRoundsEachTimerIsDueAgainAndAgain) {
  const std::string text =
      "executors: {e: {kind: single, order: rounds}}\n"
      "nodes:\n  n:\n    executor: e\n    variables: \"var last: 0..2;\"\n    callbacks:\n"
      "      a: {timer: 1, do: \"last = 1;\"}\n      b: {timer: 1, do: \"last = 2;\"}\n"
      "properties:\n"
      "  first: {ltl: \"G F (n.last == 1)\", fairness: strong}\n"
      "  second: {ltl: \"G F (n.last == 2)\", fairness: strong}\n"
      "  weakly: {ltl: \"G F (n.last == 2)\", fairness: weak}\n";
  EXPECT_EQ(verdict(text, "first"), "holds");
  EXPECT_EQ(verdict(text, "second"), "holds");
  EXPECT_EQ(verdict(text, "weakly"), "violated");
}

TEST(Executors, ATakenValueIsKeptInAVariableOfTheNode) {
  const std::string text =
      "topics: {t: {writers: w, readers: n, use: queue, with: {size: 2}}}\n"
      "programs: {w: \"t.write(1); t.write(3);\"}\n"
      "nodes: {n: {variables: \"var last: 0..3;\", callbacks: {"
      "on: {takes: \"t.read -> message(last)\", do: \"@took skip;\"}}}}\n"
      "properties: {three: \"F (n.last == 3)\", two: \"F (n.last == 2)\"}\n";
  EXPECT_EQ(verdict(text, "three"), "holds");
  EXPECT_EQ(verdict(text, "two"), "violated");
}

// Names of old files need not be words.
TEST(Executors, WhatRunsCallbacksHasANameOfItsOwn) {
  const std::string text =
      "programs: {\"n.g\": \"skip;\"}\n"
      "executors: {main: {kind: multi, threads: 2}}\n"
      "nodes:\n"
      "  n:\n"
      "    executor: main\n"
      "    groups: {g: exclusive}\n"
      "    callbacks: {c: {timer: 1, group: g, do: \"skip;\"}}\n";
  EXPECT_THAT(test::error_of([&] { nodes_from(text); }),
              HasSubstr("the program 'n.g' has the name of what runs a node's callbacks here"));
  EXPECT_EQ(verdict(replaced(text, "n.g", "p"), "deadlock"), "holds");
}

TEST(Executors, ErrorsNameThePlace) {
  const std::string text = nested_system("{kind: single}", own);
  const auto error_of = [](const std::string& changed) {
    return test::error_of([&] { nodes_from(changed); });
  };
  const auto with = [&](const std::string& what, const std::string& by) {
    return error_of(replaced(text, what, by));
  };
  const std::vector<std::pair<std::string, std::string>> errors = {
      {with("wait lookup -> answer;", "lookup.receive -> answer;"),
       "in a callback nothing is received but through its executor: say `wait lookup -> answer`"},
      {with("wait lookup -> answer;", "image.read -> message;"), "say `takes: image.read`"},
      {with("wait lookup -> answer;", "idle lookup.send;"), "a callback does not rest"},
      {with("takes: image.read", "takes: imagine.read"),
       "no callback of detector takes from 'image'"},
      {with("kind: single", "kind: multi"), "needs 'threads:'"},
      {with("kind: single", "kind: single, threads: 2"), "'threads' goes with 'kind: multi'"},
      {with("{kind: single}", "{kind: multi, threads: 2, order: rounds}"), "'order' goes with"},
      {with("takes: image.read", "takes: image.write"), "'write' is the writer's"},
      {with("takes: image.read", "takes: imageread"), "'takes' names a model and its input"},
      {with("do: \"lookup.send; wait lookup -> answer;\"", "do: {null: skip;}"),
       "to YAML `null` is none: put it in quotes"},
      {with("executor: main", "executor: mane"), "unknown executor 'mane'; there is: main"},
      {with("clients: [detector]", "clients: [camera]"), "this node is no client of lookup"},
      {with("server: database", "server: detector"), "says `serves: lookup`, and none does"},
      {with("clients: [detector]}", "clients: [detector], with: {depth: 0}}"),
       "'depth' goes from 1 to 1000"},
      {with("takes: image.read, ", "takes: image.read, timer: 3, "),
       "a callback has one of 'takes', 'timer' and 'serves'"},
      {error_of(text + "properties: {p: \"F detector:lookup.send\"}"),
       "unknown program 'detector'; there is: camera, database"},
      {error_of(text + "properties: {p: \"F detector@asked\"}"), "detector has no label 'asked'"},
      {error_of(text + "properties: {p: \"F main@end\"}"), "unknown program or node 'main'"},
      {error_of(text + "properties: {p: \"F detecter@asked\"}"),
       "unknown program or node 'detecter'; there is: camera, database, detector"},
      {with("clients: [detector]}", "clients: [detector], learn: ros3}"),
       "'learn' of a service is one of ros2, not 'ros3'"},
      {with("on_image: {", "lookup: {timer: 1, do: skip;}, on_image: {"),
       "the callback of the node's client is called 'lookup', too"},
      {with("readers: detector,",
            "readers: detector, readers_with: {detector: {size: 1}, "
            "detector.on_image: {size: 2}},"),
       "the options of reader detector.on_image are there twice"},
      {error_of(replaced(nested_system("{kind: multi, threads: 2}", own),
                         "topics:", "models: {main.threads: {use: mutex}}\ntopics:")),
       "the name 'main.threads' is taken"},
  };
  for (const auto& [error, expected] : errors) {
    EXPECT_NE(error.find(expected), std::string::npos) << error << "\n" << expected;
    EXPECT_NE(error.find("s.yaml:"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace maide
