#include "maide/join/suggest_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"

namespace maide {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::string folder = MAIDE_SOURCE_DIR "/examples/";

CheckReport check_deadlock(const System& system) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"deadlock"};
  return check_system(system, engine, request);
}

Suggestions suggest(const System& system, ModelSource models = {}) {
  SuggestOptions options;
  options.models = std::move(models);
  return suggest_changes(system, check_deadlock(system), options);
}

// For all properties of the file.
Suggestions suggest_for_all(const System& system) {
  NativeEngine engine;
  return suggest_changes(system, check_system(system, engine, {}), {});
}

TEST(SystemVariant, HasOtherCountsAndModels) {
  const System system = read_system(folder + "case-study-1/buffered.yaml");
  std::vector<Repeat> repeats = find_repeats(system);
  ASSERT_EQ(repeats.size(), 2U);
  EXPECT_EQ(repeats[0].count, 6U);
  for (Repeat& repeat : repeats) repeat.count = 12;
  const auto longer = make_variant(system, {repeats, {}, {}});
  ASSERT_TRUE(longer);
  EXPECT_EQ(find_repeats(*longer)[1].count, 12U);
  EXPECT_EQ(longer->models[0].automaton, system.models[0].automaton);
  // A model without the input that programs give is none for this system.
  InterfaceAutomaton other({"press"}, {"message"}, 1);
  EXPECT_FALSE(make_variant(system, {{}, {{"via", other}}, {}}));
  repeats[0].column += 1;
  EXPECT_FALSE(make_variant(system, {repeats, {}, {}}));
}

TEST(SuggestChange, FindsTheModelAndTheBurstThatFits) {
  const Suggestions found = suggest(read_system(folder + "case-study-1/buffered.yaml"));
  EXPECT_GT(found.tried, 4U);
  EXPECT_THAT(found.changes,
              Contains(StartsWith(
                  "via: ../models/strict-6.dot in place of ../models/buffered.dot (checked: ")));
  EXPECT_THAT(found.changes,
              Contains(StartsWith("`repeat 1` in place of `repeat 6` in lines 10 and 15")));
  // A strict port learned for one message in flight is not known to be enough.
  EXPECT_THAT(found.changes, testing::Not(Contains(HasSubstr("via: ../models/strict-1.dot"))));
}

TEST(SuggestChange, FindsTheNumberThatWasMeant) {
  const Suggestions found = suggest(read_system(folder + "case-study-2/90-100-100-size-1.yaml"));
  EXPECT_THAT(found.changes,
              Contains(StartsWith("`repeat 100` in place of `repeat 90` in line 8")));
}

// A burst of messages over a queue that keeps the last ones: none is lost if it fits.
std::string burst_over(const std::string& constants, const std::string& model) {
  return "constants: " + constants + "\nmodels: {via: " + model +
         ", done: {use: queue, with: {size: 1}}}\nprograms:\n"
         "  camera: loop { repeat burst { via.write; } done.read -> message; }\n"
         "  tracker: loop { repeat burst { via.read -> message; } done.write; }\n";
}

TEST(SuggestChange, FindsTheConstantThatFits) {
  const System system = parse_system(
      burst_over("{d: 5, burst: 12, unused: 3}", "{use: queue, with: {depth: d}}"), "s.yaml");
  ASSERT_EQ(find_constants(system).size(), 3U);
  EXPECT_EQ(find_constants(system)[1].name, "burst");
  EXPECT_EQ(find_constants(system)[1].column, 26);
  const Suggestions found = suggest(system);
  ASSERT_EQ(found.changes.size(), 2U) << testing::PrintToString(found.changes);
  EXPECT_THAT(found.changes[0],  // the same change in size as the other
              StartsWith("with d = 12 it holds, in place of 5 in line 1 (checked: "));
  EXPECT_THAT(found.changes[1],
              StartsWith("with burst <= 5 it holds, in place of 12 in line 1 (checked: "));
}

// A constant's name among the options of a system that is learned: it is learned with other values.
TEST(SuggestChange, LearnsWithTheConstantsValue) {
  std::vector<std::string> depths;
  const ModelSource learn = [&](const ModelRequest& request) {
    EXPECT_EQ(request.learn, "camera");
    EXPECT_EQ(request.with.size(), 1U);
    depths.push_back(request.with[0].second);
    const System queue = parse_system(
        "models: {q: {use: queue, with: {depth: " + depths.back() + "}}}\nprograms: {p: q.write;}",
        "q.yaml");
    return queue.models[0].automaton;
  };
  const System system = parse_system(
      burst_over("{d: 2, burst: 3}", "{learn: camera, with: {depth: d}}"), "s.yaml", learn);
  EXPECT_EQ(depths, std::vector<std::string>{"2"});
  const Suggestions found = suggest(system, learn);
  EXPECT_THAT(found.changes, Contains(StartsWith("with d = 3 it holds, in place of 2 in line 1")));
  EXPECT_THAT(depths, Contains("3"));
}

// What rclcpp needs where a callback asks and waits: a group for the client, and two threads.
TEST(SuggestChange, NamesTheCallbackGroupAndTheExecutor) {
  const System system = parse_system(
      "services: {lookup: {server: database, clients: [detector]}}\n"
      "topics: {image: {writers: camera, readers: detector, use: queue, with: {size: 2}}}\n"
      "programs:\n"
      "  camera: \"repeat 2 { image.write; }\"\n"
      "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
      "nodes:\n"
      "  detector:\n"
      "    callbacks: {on_image: {takes: image.read, do: \"lookup.send; wait lookup -> "
      "answer;\"}}\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  EXPECT_THAT(
      suggest(system).changes,
      Contains(AllOf(StartsWith("detector: the client of lookup in a callback group of its "
                                "own, and a MultiThreadedExecutor with 2 threads"),
                     HasSubstr("; nodes: {detector: {groups: {own_lookup: exclusive}, clients: "
                               "{lookup: own_lookup}"),
                     HasSubstr("executors: {executor_of_detector: {kind: multi, threads: 2}}"))));
}

// Two runs of one callback that read a variable before either writes it.
TEST(SuggestChange, NamesTheExclusiveGroup) {
  const System system = parse_system(
      "topics: {image: {writers: camera, readers: detector, use: queue, with: {size: 2}}}\n"
      "programs: {camera: \"repeat 2 { image.write; }\"}\n"
      "executors: {main: {kind: multi, threads: 2}}\n"
      "nodes:\n"
      "  detector:\n"
      "    executor: main\n"
      "    groups: {open: reentrant}\n"
      "    variables: \"var seen: 0..2; var ended: 0..2;\"\n"
      "    callbacks: {on_image: {takes: image.read, group: open, do: \"seen = seen + 1; atomic { "
      "ended = ended + 1; }\"}}\n"
      "properties: {all: \"G (detector.ended == 2 -> detector.seen == 2)\"}\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  EXPECT_THAT(suggest_for_all(system).changes,
              ElementsAre(AllOf(StartsWith("detector: the callback on_image of the reentrant group "
                                           "open in an exclusive one"),
                                HasSubstr("; nodes: {detector: {groups: {not_open: exclusive}, "
                                          "callbacks: {on_image: {group: not_open}}}}")),
                          StartsWith("`repeat 1` in place of `repeat 2`")));
}

// A longer burst brings an error that the system as it is does not have.
TEST(SuggestChange, PassesOverAChangeThatBringsAnError) {
  const System system = parse_system(
      "constants: {n: 3}\n"
      "models: {q: {use: queue, with: {size: 2}}}\n"
      "programs:\n"
      "  w: \"var k: 0..3; repeat n { q.write; k = k + 1; }\"\n"
      "  r: \"repeat 4 { q.read -> message; }\"\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  EXPECT_THAT(suggest_for_all(system).changes, ElementsAre(StartsWith("`repeat 3` in place of")));
}

// The model's writer waits for its call's return, which the topic's models do not have any more.
TEST(SuggestChange, TriesModelsAsTheyWereRead) {
  InterfaceAutomaton queue({"write", "read"}, {"written", "message"}, 1);
  queue.actors = {{"writer", {"write"}, {"written"}}, {"reader", {"read"}, {"message"}}};
  StateId before = 0;
  for (int i = 0; i < 2; ++i) {
    const StateId written = queue.add_state(), full = queue.add_state(), due = queue.add_state();
    queue.add_transition(before, {Action::Kind::input, 0}, written);
    queue.add_transition(written, {Action::Kind::output, 0}, full);
    queue.add_transition(full, {Action::Kind::input, 1}, due);
    queue.add_transition(due, {Action::Kind::output, 1}, before);
    before = full;
  }
  const System system = parse_system(
      "topics: {t: {writers: a, readers: b, file: q.dot}}\n"
      "services: {s: {server: d, clients: c, with: {depth: 2}}}\n"
      "programs:\n"
      "  d: \"loop { idle s.serve -> request; s.answer; }\"\n"
      "  c: \"s.send; s.receive -> answer;\"\n"
      "  a: \"t.write -> written; t.write -> written;\"\n"
      "  b: \"t.read -> message; loop { idle select { on t.read -> message { @second skip; } } "
      "}\"\n"
      "properties: {one: \"G !b@second\"}\n",
      "s.yaml", [&](const ModelRequest&) { return queue; });
  const auto same = make_variant(system, {{}, {}, {}});
  ASSERT_TRUE(same);
  EXPECT_EQ(same->models[0].automaton, system.models[0].automaton);
  EXPECT_THAT(suggest_for_all(system).changes, testing::IsEmpty());
}

// With another value there is a reader that the system as it is does not have.
TEST(SuggestChange, AsksForAModelThatIsNew) {
  const auto source = [](const ModelRequest& request) {
    ModelRequest file = request;
    file.file = folder + "models/ros2-topic-1.dot";
    return read_requested_model(file);
  };
  const System system = parse_system(
      "constants: {robots: 2}\n"
      "topics: {order: {writers: desk, readers: robot, file: topic.dot}}\n"
      "programs:\n"
      "  desk: \"order.write; order.write;\"\n"
      "  robot[i in 0..robots-1]: \"repeat 2 { order.read -> message; }\"\n",
      "s.yaml", source);
  EXPECT_GT(suggest(system, source).tried, suggest(system).tried);
}

// On six threads the group alone is missing; how many threads there are, a constant says.
TEST(SuggestChange, NamesTheCallbackGroupOnManyThreads) {
  const System system = parse_system(
      "constants: {n: 6}\n"
      "services: {lookup: {server: database, clients: [detector]}}\n"
      "topics: {image: {writers: camera, readers: detector, use: queue, with: {size: 1}}}\n"
      "programs:\n"
      "  camera: \"image.write;\"\n"
      "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
      "executors: {main: {kind: multi, threads: n}}\n"
      "nodes:\n"
      "  detector:\n"
      "    executor: main\n"
      "    callbacks: {on_image: {takes: image.read, do: \"lookup.send; wait lookup -> "
      "answer;\"}}\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  EXPECT_THAT(
      suggest(system).changes,
      Contains(AllOf(StartsWith("detector: the client of lookup in a callback group of its own ("),
                     HasSubstr("; nodes: {detector: {groups: {own_lookup: exclusive}, clients: "
                               "{lookup: own_lookup}}}"))));
}

// Two cures are needed, and each is named for what it cures.
TEST(SuggestChange, NamesWhatMakesAPartHold) {
  const System system = parse_system(
      "services: {lookup: {server: database, clients: [detector], with: {depth: 10}}}\n"
      "topics: {image: {writers: camera, readers: detector, use: queue, with: {depth: 2}}}\n"
      "programs:\n"
      "  camera: \"repeat 3 { image.write; }\"\n"
      "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
      "nodes:\n"
      "  detector:\n"
      "    variables: \"var n: 0..3;\"\n"
      "    callbacks: {on_image: {takes: image.read, do: \"lookup.send; wait lookup -> answer; n = "
      "n + 1;\"}}\n"
      "properties: {three: \"F detector.n == 3\"}\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  const Suggestions found = suggest_for_all(system);
  EXPECT_TRUE(found.changes.empty());
  ASSERT_TRUE(found.in_part.contains("deadlock"));
  EXPECT_THAT(found.in_part.at("deadlock"), HasSubstr("the client of lookup in a callback group"));
}

// Neither queue alone is enough; the service's depth makes no difference, and is not named.
TEST(SuggestChange, NamesOneDepthForSeveral) {
  const System system = parse_system(
      "services: {lookup: {server: database, clients: [detector], with: {depth: 1}}}\n"
      "topics:\n"
      "  image: {writers: camera, readers: detector, use: queue, with: {depth: 2}}\n"
      "  found: {writers: detector, readers: planner, use: queue, with: {depth: 2}}\n"
      "programs:\n"
      "  camera: \"repeat 4 { image.write; }\"\n"
      "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
      "nodes:\n"
      "  detector:\n"
      "    callbacks: {on_image: {takes: image.read, do: \"found.write;\"}}\n"
      "  planner:\n"
      "    variables: \"var n: 0..4;\"\n"
      "    callbacks: {on_found: {takes: found.read, do: \"n = n + 1;\"}}\n"
      "properties: {all: {ltl: \"F planner.n == 4\", fairness: strong}}\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  EXPECT_THAT(suggest_for_all(system).changes,
              ElementsAre(StartsWith("together: depth 4 in place of 2 at image and found (")));
}

TEST(SuggestChange, NamesTheDepthOfAService) {
  const System system = parse_system(
      "services: {lookup: {server: database, clients: [planner, monitor], with: {depth: 10}}}\n"
      "programs:\n"
      "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
      "  planner: \"lookup.send; lookup.receive -> answer;\"\n"
      "  monitor: \"repeat 12 { lookup.send; lookup.receive -> answer; }\"\n",
      "s.yaml", [](const ModelRequest&) { return InterfaceAutomaton(); });
  EXPECT_THAT(suggest(system).changes, Contains(StartsWith("lookup: depth 13 in place of 10")));
}

// A guest's order is answered into the group that his own callback holds. `regular`: another guest,
// whose answers push out those that nobody takes for long.
std::string kitchen(bool has_regular) {
  return std::string("services:\n  order: {server: cook, clients: [guest") +
         (has_regular ? ", regular" : "") +
         R"(]}
executors:
  hall: {kind: multi, threads: 4}
  bar: {kind: multi, threads: 2}
nodes:
  guest:
    executor: hall
    groups: {table: exclusive}
    clients: {order: table}
    callbacks:
      hungry: {timer: 100, group: table, do: "order.send; wait order -> answer;"}
)" +
         (has_regular ? R"(  regular:
    executor: bar
    groups: {seat: exclusive, glass: exclusive}
    clients: {order: seat}
    callbacks:
      thirsty: {timer: 10, group: glass, do: "order.send; wait order -> answer;"}
)"
                      : R"(  regular:
    executor: bar
    callbacks:
      thirsty: {timer: 10, do: "skip;"}
)") + R"(  cook:
    callbacks:
      serve: {serves: order, do: "order.answer;"}
)";
}

// What keeps the answer from the guest is the same, whoever else goes round.
TEST(SuggestChange, BeginsWithTheCause) {
  const std::string cure = "guest: the client of order in a callback group of its own";
  const System alone = parse_system(kitchen(false), "kitchen.yaml", read_requested_model);
  EXPECT_THAT(suggest_for_all(alone).changes, ElementsAre(StartsWith(cure)));
  const System crowd = parse_system(kitchen(true), "kitchen.yaml", read_requested_model);
  const Suggestions found = suggest_for_all(crowd);
  EXPECT_THAT(found.changes, IsEmpty());
  EXPECT_THAT(found.in_part, IsEmpty());
  ASSERT_TRUE(found.of_one_cause.contains("stuck"));
  EXPECT_THAT(found.of_one_cause.at("stuck"), StartsWith(cure));
  EXPECT_THAT(found.of_one_cause.at("stuck"), HasSubstr("clients: {order: own_order}"));
}

}  // namespace
}  // namespace maide
