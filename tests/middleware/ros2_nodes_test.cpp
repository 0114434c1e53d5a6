// Counterexamples of systems with nodes, on running rclcpp nodes: callbacks, groups and executors
// do what they say, every time. Where the real ones are others than the file says, they do not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <tuple>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "maide/base/text.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/join/real_system.hpp"
#include "maide/join/replay.hpp"
#include "maide/join/replay_plan.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

struct Case {
  std::string file, property;
  friend void PrintTo(const Case& row, std::ostream* out) {
    *out << row.file << ", " << row.property;
  }
};

// A system file of examples/ros2 at rest, as it is played, and what real nodes do.
class Nodes {
 public:
  explicit Nodes(const std::filesystem::path& file)
      : system_(read_system(
            file, record_requests(make_learning_source({file.parent_path(), {}, {}, 0}), requests_),
            {}, {}, Deliveries::at_rest)) {}

  // A run that shows that the property is violated, in an order of executors.
  Trace find_trace(const std::string& property) const {
    CheckRequest request;
    request.properties = {property};
    NativeEngine engine;
    const PropertyResult result = check_system(system_, engine, request).properties.front();
    EXPECT_EQ(result.verdict, Verdict::violated) << result.reason;
    const Trace trace = result.trace.value();
    return order_for_executors(system_, ExecutorRules(system_), trace, {}).value_or(trace);
  }

  // Another one, found among random runs of executors.
  Trace find_run(const std::string& property) const {
    const Property violated = find_property(system_, property);
    return find_run_of_executors(system_, violated, {}, 1, {}).value_or(Trace{});
  }

  std::vector<Trace> draw_runs(std::size_t count) const {
    Random random(1);
    std::vector<Trace> traces;
    for (std::size_t run = 0; run < count; ++run) {
      traces.push_back(draw_run(system_, 60, random, !system_.callbacks.empty()));
    }
    return traces;
  }

  // What came of each run over that middleware.
  std::vector<ReplayedRun> play(const std::vector<Trace>& traces,
                                const std::string& rmw = "cyclonedds") {
    const auto nodes = meet_nodes(system_, traces) ? find_nodes(system_, requests_) : nullptr;
    EXPECT_EQ(find_unplayed(system_, traces, nodes.get()).models, std::vector<std::string>{});
    const auto real = open_real_systems(system_, requests_, {0, "", {}, nodes, {{"rmw", rmw}}});
    std::vector<ReplayedRun> runs;
    play_on_real_system(system_, real, traces, {},
                        [&](std::size_t, ReplayedRun run) { runs.push_back(std::move(run)); });
    return runs;
  }

  System& system() { return system_; }

 private:
  ModelRequests requests_;
  System system_;
};

std::string text_of(const Deviation& deviation) {
  return "step " + std::to_string(deviation.step + 1) + ": expected " + deviation.expected +
         ", seen " + deviation.seen;
}

// "lost_update" of "nested/lost-update".
std::string name_of(const std::string& file) {
  std::string name = file.substr(file.find('/') + 1);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

const std::filesystem::path folder = MAIDE_SOURCE_DIR "/examples/ros2";

void use_built_wrappers() {
  const char* path = std::getenv("PATH");
  ::setenv("PATH", (MAIDE_BINARY_DIR "/bin:" + std::string(path ? path : "")).c_str(), 1);
}

// The middlewares under rclcpp on which all examples are played.
std::vector<std::string> installed_rmws() {
  std::vector<std::string> installed{"cyclonedds"};
  if (MAIDE_HAS_RMW_FASTRTPS) installed.push_back("fastrtps");
  return installed;
}

class NodesReplay : public testing::TestWithParam<std::tuple<Case, std::string>> {
 protected:
  static void SetUpTestSuite() { use_built_wrappers(); }

  static void expect_followed(std::size_t rounds) {
    const auto& [shown, rmw] = GetParam();
    Nodes nodes(folder / (shown.file + ".yaml"));
    const Trace trace = nodes.find_trace(shown.property);
    std::size_t followed = 0;
    for (const ReplayedRun& run : nodes.play(std::vector<Trace>(rounds, trace), rmw)) {
      EXPECT_FALSE(run.deviation) << text_of(*run.deviation);
      if (!run.deviation) ++followed;
    }
    EXPECT_EQ(followed, rounds);
    std::cout << "| " << shown.file << " | " << shown.property << " | " << rmw << " | "
              << trace.steps.size() << " | " << followed << " of " << rounds << " |\n";
  }
};

TEST_P(NodesReplay, IsFollowed) { expect_followed(2); }

TEST_P(NodesReplay, IsFollowedTwentyTimes) { expect_followed(20); }

std::vector<std::tuple<Case, std::string>> cases() {
  const std::vector<Case> all{
      {"strangers/strangers-nodes", "planned"}, {"nested/nested", "deadlock"},
      {"nested/reentrant", "deadlock"},         {"nested/lost-update", "all"},
      {"burst/burst-nodes", "planned"},         {"snapshot/snapshot", "order"},
      {"snapshot/snapshot-answers", "order"},   {"late-joiner/late-joiner", "once"},
      {"late-server/late-server", "stuck"},     {"camera/camera", "deadlock"},
      {"camera/camera-lost", "twelve"}};
  std::vector<std::tuple<Case, std::string>> found;
  for (const std::string& rmw : installed_rmws()) {
    for (const Case& shown : all) {
      // A file for Cyclone DDS; see AnswersThatFastDdsTakesOneByOne.
      if (shown.file == "snapshot/snapshot-answers" && rmw != "cyclonedds") continue;
      found.emplace_back(shown, rmw);
    }
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(Examples, NodesReplay, testing::ValuesIn(cases()), [](const auto& row) {
  return name_of(std::get<0>(row.param).file) + "_" + std::get<1>(row.param);
});

// Runs that the search for runs of executors finds by itself.
class FoundRuns : public NodesReplay {};

TEST_P(FoundRuns, AreFollowed) {
  const auto& [shown, rmw] = GetParam();
  Nodes nodes(folder / (shown.file + ".yaml"));
  const Trace trace = nodes.find_run(shown.property);
  ASSERT_FALSE(trace.steps.empty());
  for (const ReplayedRun& run : nodes.play({trace, trace}, rmw)) {
    EXPECT_FALSE(run.deviation) << text_of(*run.deviation);
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, FoundRuns,
                         testing::Combine(testing::Values(Case{"nested/lost-update", "all"},
                                                          Case{"snapshot/snapshot", "order"},
                                                          Case{"camera/camera-lost", "twelve"}),
                                          testing::ValuesIn(installed_rmws())),
                         [](const auto& row) {
                           return name_of(std::get<0>(row.param).file) + "_" +
                                  std::get<1>(row.param);
                         });

// ---- mended variants
// -----------------------------------------------------------------------------

class MendedNodes : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  static void SetUpTestSuite() { use_built_wrappers(); }

  static void expect_followed(std::size_t count) {
    const auto& [file, rmw] = GetParam();
    Nodes nodes(folder / (file + ".yaml"));
    const std::vector<Trace> traces = nodes.draw_runs(count);
    std::size_t followed = 0, steps = 0, deadlocks = 0;
    for (const ReplayedRun& run : nodes.play(traces, rmw)) {
      EXPECT_FALSE(run.deviation) << text_of(*run.deviation);
      if (ends_in_deadlock(nodes.system(), traces[followed])) ++deadlocks;
      if (!run.deviation) ++followed;
      steps += run.steps;
    }
    EXPECT_EQ(followed, count);
    EXPECT_GE(steps, 8 * count);
    EXPECT_EQ(deadlocks, 0u);
    std::cout << "| " << file << " | " << rmw << " | " << followed << " of " << count << " | "
              << steps << " | " << deadlocks << " |\n";
  }
};

TEST_P(MendedNodes, FollowRandomRuns) { expect_followed(3); }

TEST_P(MendedNodes, FollowAHundredRandomRuns) { expect_followed(100); }

INSTANTIATE_TEST_SUITE_P(
    Examples, MendedNodes,
    testing::Combine(testing::Values("strangers/strangers-mended", "nested/nested-mended",
                                     "burst/burst-mended", "burst/burst-10-mended",
                                     "snapshot/snapshot-mended", "snapshot/snapshot-answers-mended",
                                     "late-joiner/late-joiner-mended",
                                     "late-server/late-server-mended", "camera/camera-mended"),
                     testing::ValuesIn(installed_rmws())),
    [](const auto& row) { return name_of(std::get<0>(row.param)) + "_" + std::get<1>(row.param); });

// ---- real nodes that are others than the file says --------------------------------------------

class OtherNodes : public testing::Test {
 protected:
  static void SetUpTestSuite() { use_built_wrappers(); }

  static std::string deviation_of(Nodes& nodes, const Trace& trace,
                                  const std::string& rmw = "cyclonedds") {
    const std::vector<ReplayedRun> runs = nodes.play({trace}, rmw);
    return runs.front().deviation ? text_of(*runs.front().deviation) : "followed";
  }

  // A system file beside those of examples/ros2/nested.
  static Nodes nodes_of(const std::string& text) {
    const TempDir folder;
    const std::filesystem::path file = folder.path() / "system.yaml";
    write_file_atomically(file, replaced_all(text, "MODELS", MAIDE_SOURCE_DIR "/examples/models"));
    return Nodes(file);
  }

 private:
  static std::string replaced_all(std::string text, const std::string& from,
                                  const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    return text;
  }
};

// The callback that hangs gets its answer on a second thread, in a group of the client's own.
TEST_F(OtherNodes, ADeadlockThatIsNone) {
  Nodes nodes(folder / "nested/nested.yaml");
  const Trace trace = nodes.find_trace("deadlock");
  EXPECT_EQ(deviation_of(nodes, trace), "followed");
  for (ExecutorInstance& executor : nodes.system().executors) executor.threads = 2;
  for (CallbackInstance& callback : nodes.system().callbacks) {
    if (callback.kind == CallbackInstance::Kind::client) callback.group = "answers";
  }
  EXPECT_THAT(deviation_of(nodes, trace),
              HasSubstr("expected quiet, seen detector.on_image has its answer, detector.lookup "
                        "starts"));
}

// Two callbacks do not run at once on one thread.
TEST_F(OtherNodes, AThreadThatIsNotThere) {
  Nodes nodes(folder / "nested/reentrant.yaml");
  const Trace trace = nodes.find_trace("deadlock");
  for (ExecutorInstance& executor : nodes.system().executors) executor.threads = 1;
  EXPECT_THAT(deviation_of(nodes, trace),
              HasSubstr("expected main picks detector.on_image, seen quiet"));
}

// "order: any" lets the second callback come first for ever. A round of rclcpp's executor does not.
TEST_F(OtherNodes, AnOrderThatExecutorsDoNotTake) {
  Nodes nodes = nodes_of(R"yaml(topics:
  go: {writers: world, readers: robot.on_go, file: MODELS/ros2-topic-10.dot}
  halt: {writers: world, readers: robot.on_halt, file: MODELS/ros2-topic-10.dot}
programs:
  world: "halt.write; loop { go.write; select { when (went) { } } went = false; }"
executors:
  main: {kind: single}
nodes:
  robot:
    executor: main
    callbacks:
      on_halt: {takes: halt.read, do: "halted = true;"}
      on_go: {takes: go.read, do: "went = true;"}
variables: "var halted: bool; var went: bool;"
properties:
  halts: {ltl: "F (halted)"}
)yaml");
  const Trace trace = nodes.find_trace("halts");
  EXPECT_THAT(deviation_of(nodes, trace),
              HasSubstr("expected main picks robot.on_go, seen main picks robot.on_halt"));
}

// Over Fast DDS the client's turn takes the operator's answer alone, and the move is handled first.
TEST_F(OtherNodes, AnswersThatFastDdsTakesOneByOne) {
  if (!MAIDE_HAS_RMW_FASTRTPS) GTEST_SKIP() << "skipped: no rmw_fastrtps_cpp";
  Nodes nodes(folder / "snapshot/snapshot-answers.yaml");
  const Trace trace = nodes.find_trace("order");
  EXPECT_EQ(deviation_of(nodes, trace, "fastrtps"),
            "step 16: expected robot.lookup starts, seen quiet");
}

// A request that was served may be answered by another callback of the node.
TEST_F(OtherNodes, AnAnswerThatComesLater) {
  Nodes nodes = nodes_of(R"yaml(services:
  lookup: {server: map, clients: [planner], learn: ros2}
programs:
  planner: "loop { lookup.send; lookup.receive -> answer; }"
nodes:
  map:
    callbacks:
      find: {serves: lookup, do: "skip;"}
      later: {timer: 10, do: "lookup.answer;"}
)yaml");
  std::size_t answers = 0;
  const std::vector<Trace> traces = nodes.draw_runs(20);
  for (const Trace& trace : traces) {
    for (const Step& step : trace.steps) {
      const std::string event = describe_step(nodes.system(), step).event;
      if (event.find("!answer") != std::string::npos) ++answers;
    }
  }
  EXPECT_GT(answers, 5U);
  for (const ReplayedRun& run : nodes.play(traces)) {
    EXPECT_FALSE(run.deviation) << text_of(*run.deviation);
  }
}

TEST_F(OtherNodes, WhatCannotBePlayedIsOneLine) {
  const auto error_of = [](const std::string& text) -> std::string {
    ModelRequests requests;
    const TempDir folder;
    const std::filesystem::path file = folder.path() / "system.yaml";
    write_file_atomically(file, text);
    const System system = read_system(
        file, record_requests(make_learning_source({folder.path(), {}, {}, 0}), requests));
    try {
      find_nodes(system, requests);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of(R"(topics:
  go: {writers: world, readers: robot.on_go, use: queue, with: {depth: 2}}
programs:
  world: "go.write;"
nodes:
  robot:
    callbacks:
      on_go: {takes: go.read, do: "skip;"}
)"),
              HasSubstr("topic go is a queue that is written by hand, so there is nothing real to "
                        "run"));
  EXPECT_THAT(error_of(R"(services:
  ask: {server: map, clients: [robot], with: {depth: unknown}}
nodes:
  map:
    callbacks:
      find: {serves: ask, do: "ask.answer;"}
  robot:
    callbacks:
      tick: {timer: 10, do: "ask.send;"}
)"),
              HasSubstr("service ask: its depth is unknown"));
}

}  // namespace
}  // namespace maide
