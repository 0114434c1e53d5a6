// The rules of executors, and the runs that go by them.
#include "maide/ros2/executor_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/ros2/executor_runs.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Two subscriptions and a timer of a node, and a service of another one, on one executor.
System system_with(const std::string& executor, const std::string& robot = "") {
  return parse_system(R"(topics:
  go: {writers: driver, readers: robot.on_go, delivery: at_once, use: queue, with: {depth: 3}}
  halt: {writers: guard, readers: robot.on_halt, delivery: at_once, use: queue, with: {depth: 3}}
services:
  ask: {server: map, delivery: at_once, clients: [robot]}
programs:
  driver: "loop { go.write; }"
  guard: "loop { halt.write; }"
executors:
  main: )" + executor + R"(
nodes:
  map:
    executor: main
    callbacks:
      find: {serves: ask, do: "ask.answer;"}
  robot:
    executor: main
)" + robot + R"(
    callbacks:
      on_go: {takes: go.read, do: "skip;"}
      on_halt: {takes: halt.read, do: "skip;"}
      tick: {timer: 10, do: "ask.send;"}
)",
                      "system.yaml");
}

std::uint32_t callback_named(const System& system, const std::string& name) {
  std::uint32_t number = 0;
  while (system.callbacks.at(number).name != name) ++number;
  return number;
}

// "go[robot.on_go].write": the events of a step, inputs behind a dot and outputs behind a `!`.
std::string event_text(const System& system, const Step& step) {
  std::string events;
  for (const ModelUse& event : events_of(system, step)) {
    const ModelInstance& model = system.models[event.model];
    const bool gives = event.kind == ModelUse::Kind::give;
    events += model.name + (gives ? "." : "!") +
              (gives ? model.automaton.inputs() : model.automaton.outputs()).name(event.index);
  }
  return events;
}

// A system with the rules of its executors, on which steps are taken by what they say.
class Executor {
 public:
  explicit Executor(System system)
      : system_(std::move(system)), rules_(system_), state_(rules_.initial()) {
    at_ = initial_state(system_);
  }

  void take(const std::string& text) {
    for (const Step& step : enabled_steps(system_, at_)) {
      const Program& program = system_.programs[step.actor];
      const ProgramEdge& edge = program.edges[step.action];
      const std::string events = event_text(system_, step);
      const bool is_combined = edge.kind == ModelUse::Kind::combined;
      if (events != text && !(is_combined && program.combined[edge.index].text == text)) continue;
      trace.steps.push_back(step);
      at_ = apply(system_, at_, step);
      return;
    }
    FAIL() << text << " is not possible";
  }
  void write(const std::string& topic) { take(topic + "[robot.on_" + topic + "].write"); }

  // What threads pick, one after the other, until they find nothing.
  std::vector<std::string> picks(const std::vector<std::string>& due = {}) {
    std::vector<std::uint32_t> timers;
    for (const std::string& name : due) timers.push_back(callback_named(system_, name));
    std::vector<std::string> names;
    while (const auto callback = rules_.pick(state_, 0, at_, timers)) {
      names.push_back(system_.callbacks[*callback].name);
      timers.clear();
    }
    return names;
  }
  bool is_found(const std::string& name) const {
    return rules_.is_ready(callback_named(system_, name), at_);
  }
  void start_and_end(const std::string& name) {
    const std::uint32_t callback = callback_named(system_, name);
    rules_.end(state_, callback, rules_.start(state_, callback));
  }

  const System& system() const { return system_; }
  const ExecutorRules& rules() const { return rules_; }
  Trace trace;

 private:
  System system_;
  ExecutorRules rules_;
  ExecutorRules::State state_;
  GlobalState at_;
};

TEST(ExecutorRules, OneThreadPicksTimersFirst) {
  Executor executor(system_with("{kind: single}"));
  EXPECT_THAT(executor.picks(), IsEmpty());
  executor.write("halt");
  executor.write("go");
  EXPECT_THAT(executor.picks({"robot.tick"}), ElementsAre("robot.tick"));
  EXPECT_THAT(executor.picks(), IsEmpty());  // its thread has picked
}

TEST(ExecutorRules, ALookIsUsedUpBeforeTheNext) {
  Executor executor(system_with("{kind: single}"));
  executor.write("halt");
  EXPECT_THAT(executor.picks(), ElementsAre("robot.on_halt"));
  executor.write("go");
  executor.start_and_end("robot.on_halt");  // its message is not taken: it is there again
  EXPECT_THAT(executor.picks({"robot.tick"}), ElementsAre("robot.tick"));
  executor.start_and_end("robot.tick");
  EXPECT_THAT(executor.picks({"robot.tick"}), ElementsAre("robot.on_go"));  // of the last look
  executor.start_and_end("robot.on_go");
  EXPECT_THAT(executor.picks({"robot.tick"}), ElementsAre("robot.on_halt"));
}

TEST(ExecutorRules, AGroupThatIsBusyIsPassedOver) {
  Executor executor(system_with("{kind: multi, threads: 3}"));
  executor.write("halt");
  executor.write("go");
  EXPECT_THAT(executor.picks(), ElementsAre("robot.on_go"));  // on_halt is of the same group
}

TEST(ExecutorRules, ThreadsPickWhatGroupsAllow) {
  Executor executor(system_with("{kind: multi, threads: 3}", R"(    groups: {open: reentrant}
    clients: {ask: open})"));
  executor.write("halt");
  EXPECT_THAT(executor.picks({"robot.tick"}), ElementsAre("robot.tick"));
}

// Two answers to another client are in its queue.
Executor executor_of_client(const std::string& order, const std::string& rmw) {
  Executor executor(parse_system(R"(services:
  s: {server: map, delivery: at_once, clients: [robot, other], with: {depth: 2, rmw: )" +
                                     rmw + R"(}}
programs:
  other: "s.send; s.send;"
  map: "loop { s.serve -> request; s.answer; }"
executors:
  main: {kind: single, order: )" + order +
                                     R"(}
nodes:
  robot:
    executor: main
    callbacks: {tick: {timer: 10, do: "s.send;"}}
)",
                                 "system.yaml"));
  for (int call = 0; call < 2; ++call) {
    for (const char* step : {"s.send2", "s.serve", "s!request", "s.answer"}) executor.take(step);
  }
  return executor;
}

TEST(ExecutorRules, AClientIsPickedForAnswersToOthers) {
  const auto picks = [](const std::string& order) {
    return executor_of_client(order, "cyclonedds").picks();
  };
  EXPECT_THAT(picks("any"), IsEmpty());
  EXPECT_THAT(picks("rounds"), ElementsAre("robot.s"));
}

// The look picks it, and the step that discards asks for no other pick. Over Fast DDS there is a
// second answer.
TEST(ExecutorRules, AScheduleHasWhatClientsDiscard) {
  for (const std::string rmw : {"cyclonedds", "fastrtps"}) {
    Executor executor = executor_of_client("rounds", rmw);
    const std::size_t before = executor.trace.steps.size();
    const bool is_one = rmw == "fastrtps";
    const int turns = is_one ? 2 : 1;
    for (int turn = 0; turn < turns; ++turn) {
      executor.take("finds robot.s");
      executor.take(is_one ? "robot.s throws away an answer to another"
                           : "robot.s throws away answers to others");
    }
    std::vector<std::size_t> moves(executor.trace.steps.size());
    for (std::size_t move = 0; move < moves.size(); ++move) moves[move] = move;
    const auto steps = schedule(executor.system(), executor.rules(), executor.trace, moves);
    ASSERT_EQ(steps.size(), moves.size());
    const std::uint32_t client = callback_named(executor.system(), "robot.s");
    for (std::size_t step = before; step < steps.size(); step += 2) {
      EXPECT_THAT(steps[step].picks, ElementsAre(client));
      EXPECT_THAT(steps[step + 1].picks, IsEmpty());
      EXPECT_EQ(discarded_by(executor.system(), executor.trace.steps[step + 1]), client);
      EXPECT_FALSE(started_by(executor.system(), executor.trace.steps[step + 1]));
    }
    EXPECT_FALSE(executor.is_found("robot.s"));
  }
}

// The message for on_halt comes first, but a thread that looks late runs on_go. One that looked as
// soon as the message was there is what the run needs.
TEST(ExecutorRules, AScheduleLetsThreadsPickBefore) {
  Executor executor(system_with("{kind: single}"));
  executor.write("halt");
  executor.write("go");
  executor.take("robot.on_halt starts: halt[robot.on_halt].read -> message");
  std::vector<std::size_t> moves(executor.trace.steps.size());
  for (std::size_t move = 0; move < moves.size(); ++move) moves[move] = move;
  const auto steps = schedule(executor.system(), executor.rules(), executor.trace, moves);
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_THAT(steps[1].picks, ElementsAre(callback_named(executor.system(), "robot.on_halt")));
  EXPECT_THAT(steps[2].picks, IsEmpty());
}

// Both messages are there before the thread is idle again, so on_go would come next. It does not if
// its message comes later.
TEST(ExecutorRules, StepsOfOthersMayComeLater) {
  Executor executor(system_with("{kind: single}"));
  executor.write("halt");
  executor.take("robot.on_halt starts: halt[robot.on_halt].read -> message");
  executor.write("go");
  executor.write("halt");
  executor.take("robot.on_halt ends");
  executor.take("robot.on_halt starts: halt[robot.on_halt].read -> message");
  const auto ordered = order_for_executors(executor.system(), executor.rules(), executor.trace, {});
  ASSERT_TRUE(ordered);
  EXPECT_EQ(replay(executor.system(), *ordered).back(),
            replay(executor.system(), executor.trace).back());
  EXPECT_NE(*ordered, executor.trace);
}

TEST(NodeRuns, StartWhatExecutorsPick) {
  const System system = system_with("{kind: single}");
  const ExecutorRules rules(system);
  NodeRuns runs(system);
  GlobalState at = initial_state(system);
  std::size_t starts = 0;
  Random random(3);
  for (int count = 0; count < 300; ++count) {
    std::vector<Step> steps = enabled_steps(system, at);
    std::erase_if(steps, [](const Step& step) { return step.is_beyond; });
    runs.restrict(at, steps);
    if (steps.empty()) break;
    const Step step = steps[random.below(steps.size())];
    if (started_by(system, step)) ++starts;
    runs.take(at, step);
    at = apply(system, at, step);
  }
  EXPECT_GT(starts, 20u);
}

// By `order: any` either queue may overflow. An executor that runs all that a look found never lets
// more than two poses wait, so by its rules it is the first queue alone.
const std::string pipeline =
    "topics:\n"
    "  scan: {writers: laser, readers: matcher, delivery: at_once, use: queue, with: {depth: "
    "FIRST}}\n"
    "  pose: {writers: matcher, readers: mission, delivery: at_once, use: queue, with: {depth: "
    "2}}\n"
    "programs: {laser: \"repeat 4 { scan.write; }\"}\n"
    "executors: {main: {kind: single}}\n"
    "nodes:\n"
    "  matcher:\n"
    "    executor: main\n"
    "    callbacks: {on_scan: {takes: scan.read, do: \"pose.write;\"}}\n"
    "  mission:\n"
    "    executor: main\n"
    "    variables: \"var n: 0..4;\"\n"
    "    callbacks: {on_pose: {takes: pose.read, do: \"n = n + 1;\"}}\n"
    "properties: {all: {ltl: \"F mission.n == 4\", fairness: strong}}\n";

System pipeline_of(const std::string& depth) {
  std::string text = pipeline;
  text.replace(text.find("FIRST"), 5, depth);
  return parse_system(text, "s.yaml");
}

TEST(RunOfExecutors, ViolatesAndIsOneThatTheyTake) {
  const System system = pipeline_of("2");
  const Property all = find_property(system, "all");
  const auto run = find_run_of_executors(system, all, {}, 7, {});
  ASSERT_TRUE(run);
  EXPECT_EQ(find_flaw_in_parts(system, all, *run), "");
  const ExecutorRules rules(system);
  EXPECT_TRUE(order_for_executors(system, rules, *run, {}));
  // The same seed, the same run.
  const auto again = find_run_of_executors(system, all, {}, 7, {});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->steps, run->steps);
  EXPECT_EQ(again->loop_start, run->loop_start);
}

// The second queue overflows only if the mission's callback is passed over twice.
TEST(RunOfExecutors, IsNoneWhereOnlyAnotherOrderViolates) {
  const System system = pipeline_of("4");
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"all"};
  EXPECT_EQ(check_system(system, engine, request).verdict, Verdict::violated);
  EXPECT_FALSE(find_run_of_executors(system, find_property(system, "all"), {}, 7, {}));
}

TEST(RunOfExecutors, IsNoneWhereItHolds) {
  std::string text = pipeline;
  text.replace(text.find("FIRST"), 5, "4");
  text.replace(text.find("depth: 2"), 8, "depth: 4");
  const System system = parse_system(text, "s.yaml");
  EXPECT_FALSE(find_run_of_executors(system, find_property(system, "all"), {}, 7, {}));
}

// Of a system whose components do not notice each other.
CheckReport check_preferring(const System& system, const RunControl& control = {}) {
  NativeEngine engine;
  CheckReport report = check_system(system, engine, {});
  prefer_runs_of_executors(system, report, control);
  return report;
}

const PropertyResult& result_of(const CheckReport& report, const std::string& name) {
  return *std::find_if(report.properties.begin(), report.properties.end(),
                       [&](const PropertyResult& result) { return result.name == name; });
}

// An error by an order that executors do not take, beside an error of another program.
TEST(RunOfExecutors, IsOneOfTheComponentThatIsShown) {
  const System system = parse_system(R"(topics:
  a: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 1}}
  b: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 1}}
models: {m: {use: mutex}}
programs:
  w: "a.write; b.write;"
  p: "var k: 0..1; loop { m.lock; m.unlock; k = k + 1; }"
nodes:
  n:
    variables: "var seen: bool; var bad: 0..1;"
    callbacks:
      on_a: {takes: a.read, do: "seen = true;"}
      on_b: {takes: b.read, do: "if (!seen) { bad = bad + 2; }"}
)",
                                     "s.yaml");
  const CheckReport report = check_preferring(system);
  const PropertyResult& error = result_of(report, "error");
  ASSERT_EQ(error.verdict, Verdict::violated);
  const Shown shown = shown_part(system, error);
  EXPECT_EQ(find_flaw(shown.part.system(), shown.property, shown.trace), "");
  EXPECT_THAT(report.doubts, ElementsAre(testing::HasSubstr("error: no run was found in which")));
}

// Both components go on; the run is of the first alone, and the reason is that of its end.
TEST(RunOfExecutors, LeavesOtherComponentsOut) {
  const System system = parse_system(R"(topics:
  a: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 2}}
models: {m: {use: mutex}}
programs:
  w: "loop { a.write; }"
  p: "loop { m.lock; m.unlock; }"
nodes:
  n:
    variables: "var count: 0..2;"
    callbacks: {on_a: {takes: a.read, do: "count = count + 1;"}}
)",
                                     "s.yaml");
  const CheckReport report = check_preferring(system);
  const PropertyResult& error = result_of(report, "error");
  ASSERT_EQ(error.verdict, Verdict::violated);
  const auto run =
      find_run_of_executors(system, find_property(system, "error"), error.programs, 1, {});
  ASSERT_TRUE(run);
  for (const Step& step : run->steps) EXPECT_NE(system.programs[step.actor].name, "p");
  EXPECT_THAT(report.doubts, IsEmpty());
}

TEST(RunOfExecutors, IsNotLookedForWhenTheTimeIsUp) {
  const System system = pipeline_of("4");
  RunControl control;
  control.deadline = std::chrono::steady_clock::now();
  EXPECT_THAT(check_preferring(system, control).doubts,
              testing::Contains(testing::HasSubstr("for the search ended early")));
}

// What arrives late arrives late in runs of executors, too.
TEST(RunOfExecutors, HasMessagesOnTheirWay) {
  const System system = parse_system(R"(topics:
  chart: {writers: map, readers: robot.on_chart, use: queue, with: {depth: 1}}
services: {ask: {server: map, clients: [robot]}}
programs: {map: "ask.serve -> request; chart.write; ask.answer;"}
nodes:
  robot:
    variables: "var has_chart: bool; var answered: bool;"
    clients: {ask: {do: "answered = true;"}}
    callbacks:
      start: {timer: 100, do: "ask.send;"}
      on_chart: {takes: chart.read, do: "has_chart = true;"}
properties: {p: {always: "robot.answered -> robot.has_chart"}}
)",
                                     "s.yaml");
  const Property property = find_property(system, "p");
  const auto run = find_run_of_executors(system, property, {}, 1, {});
  ASSERT_TRUE(run);
  EXPECT_EQ(find_flaw(system, property, *run), "");
  EXPECT_TRUE(
      std::ranges::any_of(run->steps, [](const Step& step) { return step.actor == nobody; }));
  const ExecutorRules rules(system);
  EXPECT_TRUE(order_for_executors(system, rules, *run, {}));
}

// Two subscriptions of one node: a run that leaves one of them out for ever is none of executors.
TEST(RunOfExecutors, HasLoopsThatExecutorsRepeat) {
  const System system = parse_system(R"(topics:
  t: {writers: w, readers: [n.on_t, n.also], delivery: at_once, use: queue, with: {depth: 1}}
programs: {w: "loop { t.write; }"}
nodes:
  n:
    callbacks:
      on_t: {takes: t.read, do: "skip;"}
      also: {takes: t.read, do: "@z skip;"}
properties: {two: "F n.also@z"}
)",
                                     "s.yaml");
  const CheckReport report = check_preferring(system);
  ASSERT_EQ(result_of(report, "two").verdict, Verdict::violated);
  const ExecutorRules rules(system);
  const Trace& shown = *result_of(report, "two").trace;
  const auto ordered = order_for_executors(system, rules, shown, {});
  EXPECT_EQ(ordered.has_value(), report.doubts.empty());
  if (ordered) {
    const auto again = order_for_executors(system, rules, *ordered, {});
    EXPECT_EQ(again, ordered);
  }
}

// What the look found for the second callback, the first one took.
TEST(RunOfExecutors, PassesOverWhatIsGone) {
  const System system = parse_system(
      R"(models: {go: {use: semaphore, with: {count: 1}}, q: {delivery: at_once, use: queue, with: {size: 1}}}
executors: {main: {kind: single, order: rounds}}
nodes:
  n:
    executor: main
    callbacks:
      a: {takes: go.acquire, do: "q.write;"}
      b: {takes: go.acquire, do: "q.write;"}
      c: {takes: q.read -> message, do: "@x skip;"}
properties: {p: "G !n@x"}
)",
      "s.yaml");
  const CheckReport report = check_preferring(system);
  EXPECT_EQ(result_of(report, "p").verdict, Verdict::violated);
  EXPECT_THAT(report.doubts, IsEmpty());
}

TEST(RunOfExecutors, MayBeLong) {
  const System system = parse_system(
      "models: {m: {use: mutex}}\n"
      "programs: {p: \"repeat 20000 { m.lock; m.unlock; } m.lock; m.lock;\"}\n"
      "nodes: {n: {callbacks: {tick: {timer: 1, do: \"skip;\"}}}}\n",
      "s.yaml");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  const PropertyResult& deadlock = result_of(report, "deadlock");
  ASSERT_TRUE(deadlock.trace);
  EXPECT_EQ(order_for_executors(system, ExecutorRules(system), *deadlock.trace, {}),
            deadlock.trace);
}

// ---- the machine that was learned from rclcpp ---------------------------------------------------

// Two subscriptions of depth 1 on one executor: what each word of arrivals and spins runs.
class TwoSubscriptions {
 public:
  explicit TwoSubscriptions(const std::string& order)
      : system_(parse_system(R"(topics:
  first: {writers: one, readers: robot.sub1, delivery: at_once, use: queue, with: {depth: 1}}
  second: {writers: two, readers: robot.sub2, delivery: at_once, use: queue, with: {depth: 1}}
programs:
  one: "loop { first.write; }"
  two: "loop { second.write; }"
executors:
  main: {kind: single, order: )" +
                                 order + R"(}
nodes:
  robot:
    executor: main
    callbacks:
      sub1: {takes: first.read, do: "skip;"}
      sub2: {takes: second.read, do: "skip;"}
)",
                             "system.yaml")),
        rules_(system_) {}

  void restart() {
    at_ = initial_state(system_);
    state_ = rules_.initial();
  }
  void arrive(const std::string& topic) {
    do_step([&](const Step& step) {
      const std::string events = event_text(system_, step);
      return events.starts_with(topic + "[robot.") && events.ends_with(".write");
    });
  }
  // By the rules of the replay: what the thread picks, started and ended.
  std::string spin_by_rules() {
    const auto picked = rules_.pick(state_, 0, at_, {});
    if (!picked) return "nothing";
    do_step([&](const Step& step) { return started_by(system_, step) == picked; });
    do_step([&](const Step& step) { return is_end_of_callback(system_, step); });
    rules_.end(state_, *picked, rules_.start(state_, *picked));
    return name_of(*picked);
  }
  // By the steps of the system, of which all that start a callback must start the same one.
  std::string spin_by_steps() {
    std::set<std::uint32_t> startable = find_startable();
    if (startable.empty() &&
        do_step([&](const Step& step) { return !found_by(system_, step).empty(); })) {
      startable = find_startable();
    }
    if (startable.empty()) return "nothing";
    if (startable.size() > 1) return "several";
    const std::uint32_t callback = *startable.begin();
    do_step([&](const Step& step) { return started_by(system_, step) == callback; });
    do_step([&](const Step& step) { return is_end_of_callback(system_, step); });
    return name_of(callback);
  }

 private:
  std::string name_of(std::uint32_t callback) const {  // "robot.sub1" is "sub1"
    return system_.callbacks[callback].name.substr(6);
  }
  template <typename Wanted>
  bool do_step(const Wanted& wanted) {
    for (const Step& step : enabled_steps(system_, at_)) {
      if (!wanted(step)) continue;
      at_ = apply(system_, at_, step);
      return true;
    }
    return false;
  }
  std::set<std::uint32_t> find_startable() const {
    std::set<std::uint32_t> callbacks;
    for (const Step& step : enabled_steps(system_, at_)) {
      if (const auto started = started_by(system_, step)) callbacks.insert(*started);
    }
    return callbacks;
  }

  System system_;
  ExecutorRules rules_;
  GlobalState at_;
  ExecutorRules::State state_;
};

// All words of that length that the machine takes, with what it runs at each spin.
void for_each_word(const InterfaceAutomaton& machine, std::size_t length,
                   const std::function<void(const std::vector<std::string>&,
                                            const std::vector<std::string>&)>& look) {
  const std::vector<std::string> inputs{"arrive1", "arrive2", "spin"};
  for (std::size_t code = 0; code < static_cast<std::size_t>(std::pow(3, length)); ++code) {
    StateId state = machine.initial();
    std::vector<std::string> word, ran;
    for (std::size_t i = 0, rest = code; i < length; ++i, rest /= 3) {
      word.push_back(inputs[rest % 3]);
      const Symbol input = machine.inputs().at(word.back());
      state = machine.successor(state, {Action::Kind::input, input});
      for (const auto& transition : machine.transitions(state)) {
        if (transition.action.is_input()) continue;
        ran.push_back(machine.outputs().name(transition.action.symbol));
        state = transition.target;
        break;
      }
    }
    look(word, ran);
  }
}

TEST(ExecutorRules, AreThoseOfTheMachineLearnedFromRclcpp) {
  const InterfaceAutomaton machine =
      read_interface_automaton(MAIDE_SOURCE_DIR "/examples/models/ros2-executor-once.dot");
  const auto expect_same = [&](const std::string& order, auto spin) {
    TwoSubscriptions system(order);
    std::size_t words = 0, runs = 0;
    for_each_word(machine, 7, [&](const auto& word, const auto& expected) {
      system.restart();
      std::vector<std::string> ran;
      for (const std::string& input : word) {
        if (input == "spin") {
          ran.push_back((system.*spin)());
        } else {
          system.arrive(input == "arrive1" ? "first" : "second");
        }
      }
      ASSERT_EQ(ran, expected) << order << ": " << testing::PrintToString(word);
      ++words;
      runs += ran.size();
    });
    EXPECT_EQ(words, 2187U);
    EXPECT_GT(runs, words);
  };
  expect_same("rounds", &TwoSubscriptions::spin_by_steps);
  expect_same("any", &TwoSubscriptions::spin_by_rules);
}

}  // namespace
}  // namespace maide
