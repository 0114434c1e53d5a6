// Architectures over real middleware: each of examples/architectures/on-middleware has the verdicts
// that its first lines name, and the real middleware follows its counterexample, every time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "at_rest.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/join/real_system.hpp"
#include "maide/join/replay.hpp"
#include "maide/join/replay_plan.hpp"

namespace maide {
namespace {

// "token-cyclonedds": the middleware stands behind the last hyphen.
class ArchitectureReplay : public testing::TestWithParam<std::string> {
 protected:
  static void SetUpTestSuite() {
    const char* path = std::getenv("PATH");
    ::setenv("PATH", (MAIDE_BINARY_DIR "/bin:" + std::string(path ? path : "")).c_str(), 1);
  }
  void SetUp() override {
    const std::string middleware = GetParam().substr(GetParam().rfind('-') + 1);
    if (!find_wrapper(middleware)) {
      GTEST_SKIP() << "skipped: maide-wrap-" << middleware << " is not built";
    }
    const std::string name = GetParam() + ".yaml";
    const std::string text =
        read_file(MAIDE_SOURCE_DIR "/examples/architectures/on-middleware/" + name);
    write_file_atomically(folder_.path() / name, text);
    const ModelSource models =
        record_requests(make_learning_source({folder_.path(), {}, {}, 0}), requests_);
    system_ = read_system(folder_.path() / name, models);
    for (const std::string_view line : split_lines(text)) {
      if (!line.starts_with("# ") || !line.ends_with(": violated")) continue;
      CheckRequest request;
      request.properties = {std::string(line.substr(2, line.find(':') - 2))};
      NativeEngine engine;
      result_ = check_system(system_, engine, request).properties.front();
      ASSERT_EQ(to_string(result_.verdict), to_string(Verdict::violated)) << result_.reason;
    }
    ASSERT_TRUE(result_.trace) << "the file names no property that is violated";
    system_ = test::at_rest(system_, folder_.path() / name, models, result_);
  }

  void expect_followed(std::size_t rounds) {
    const Trace& trace = *result_.trace;
    EXPECT_EQ(find_unplayed(system_, {&trace, 1}).models, std::vector<std::string>{});
    EXPECT_EQ(find_assumptions(system_, trace), std::vector<std::string>{});
    const auto real = open_real_systems(system_, requests_, {0, "", {}});
    const std::vector<Trace> traces(rounds, trace);
    std::size_t followed = 0;
    play_on_real_system(system_, real, traces, {}, [&](std::size_t round, ReplayedRun run) {
      EXPECT_FALSE(run.deviation) << "round " << round << ", step " << run.deviation->step
                                  << ": expected " << run.deviation->expected << ", seen "
                                  << run.deviation->seen;
      EXPECT_EQ(run.steps,
                trace.steps.size() +
                    (trace.loop_start ? 2 * (trace.steps.size() - *trace.loop_start) : 0));
      if (!run.deviation) ++followed;
    });
    EXPECT_EQ(followed, rounds);
    std::cout << GetParam() << ": " << result_.name << ", " << trace.steps.size() << " steps, "
              << followed << " of " << rounds << " followed\n";
  }

  TempDir folder_{"maide-architecture-"};
  ModelRequests requests_;
  System system_;
  PropertyResult result_;
};

TEST_P(ArchitectureReplay, IsFollowed) { expect_followed(1); }

TEST_P(ArchitectureReplay, IsFollowedTwentyTimes) { expect_followed(20); }

INSTANTIATE_TEST_SUITE_P(Examples, ArchitectureReplay,
                         testing::Values("token-cyclonedds", "retry-zeromq", "lifecycle-mqtt",
                                         "heartbeats-ros1", "two-by-two-fastdds",
                                         "cancel-cyclonedds", "topic-cyclonedds", "strangers-ros2",
                                         "burst-ros2"),
                         [](const auto& row) {
                           std::string name = row.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace maide
