// `maide ros2 import` and `maide doctor ros2`, from a graph in a file. tests/middleware reads a
// running one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "maide/experiment/open_system.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

const std::string graph = std::string(MAIDE_SOURCE_DIR) + "/tests/systems/ros2-graph.json";

TEST(Ros2Import, WritesASystemFile) {
  const TempDir folder;
  const std::string file = (folder.path() / "s.yaml").string();
  const SubprocessResult printed = run_maide({"ros2", "import", "--graph", graph});
  EXPECT_EQ(printed.exit_status, 0);
  const SubprocessResult written = run_maide({"ros2", "import", "--graph", graph, "-o", file});
  EXPECT_EQ(written.exit_status, 0);
  EXPECT_THAT(written.out, HasSubstr("5 topics, 2 services, 7 nodes"));
  EXPECT_EQ(read_file(file), printed.out);
  EXPECT_EQ(run_maide({"format", "--check", file}).exit_status, 0);
  // What --json prints is a graph again.
  const SubprocessResult json = run_maide({"ros2", "import", "--graph", graph, "--json"});
  EXPECT_EQ(json_of(json).at("system"), printed.out);
  const std::string again = (folder.path() / "again.json").string();
  write_file_atomically(again, json.out);
  EXPECT_EQ(run_maide({"ros2", "import", "--graph", again}).out, printed.out);
}

// The call in the callback is found whatever the depths are; what they decide is open.
TEST(Ros2Import, IsCheckedBeforeDepthsAreKnown) {
  const TempDir folder;
  const std::string file = (folder.path() / "s.yaml").string();
  std::string text = run_maide({"ros2", "import", "--graph", graph}).out;
  const auto replace = [&](const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
  };
  replace("logger: {depth: 5", "logger: {depth: unknown");
  for (std::string::size_type at; (at = text.find("do: unknown}")) != std::string::npos;) {
    text.replace(at, 11, "do: \"skip;\"");
  }
  replace("tick: {timer: 100, do: \"skip;\"}", "tick: {timer: 33, do: \"image.write;\"}");
  write_file_atomically(file, text);
  const SubprocessResult open = run_maide({"check", file, "--property", "deadlock"});
  EXPECT_EQ(open.exit_status, 3);
  EXPECT_THAT(open.err, HasSubstr("'depth: unknown': write how many messages are kept"));
  EXPECT_THAT(open.out, HasSubstr("is not known (depth: unknown)"));
  replace("takes: image.read, do: \"skip;\"",
          "takes: image.read, do: \"lookup.send; wait lookup -> answer;\"");
  write_file_atomically(file, text);
  const SubprocessResult hangs = run_maide({"check", file, "--property", "stuck"});
  EXPECT_EQ(hangs.exit_status, 1);
  EXPECT_THAT(hangs.out, HasSubstr("(detector.on_image) for lookup!answer"));
}

TEST(Ros2Doctor, SaysWhatNeverMatches) {
  const SubprocessResult text = run_maide({"doctor", "ros2", graph});
  EXPECT_EQ(text.exit_status, 1);
  EXPECT_THAT(text.out, HasSubstr("Never match\n  /health: /camera offers best_effort"));
  EXPECT_THAT(text.out, HasSubstr("\n1 pair of ends never matches.\n"));
  const Json json = json_of(run_maide({"doctor", "ros2", graph, "--json"}));
  EXPECT_EQ(json.at("matches"), false);
  EXPECT_EQ(json.at("findings").size(), 12U);
  EXPECT_EQ(json.at("findings")[0].at("kind"), "no_match");
}

TEST(Ros2Doctor, ReadsSystemFiles) {
  const SubprocessResult result = run_maide(
      {"doctor", "ros2", std::string(MAIDE_SOURCE_DIR) + "/examples/ros2/camera/camera.yaml"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.out, HasSubstr("image: detector keeps the newest 10: of a burst of 11"));
  EXPECT_THAT(result.out, HasSubstr("lookup: of 11 requests"));
  EXPECT_THAT(result.out, HasSubstr("All ends match."));
}

TEST(Ros2Import, BadInputIsOneLine) {
  const TempDir folder;
  const std::string file = (folder.path() / "g.json").string();
  write_file_atomically(file, "{\"nodes\": []}");
  expect_error(run_maide({"ros2", "import", "--graph", file}), 2, "this is no graph of ROS 2");
  write_file_atomically(file, R"({"nodes": [], "topics": [], "services": []})");
  expect_error(run_maide({"ros2", "import", "--graph", file}), 2,
               "there is no topic and no service");
  write_file_atomically(file, "{");
  expect_error(run_maide({"doctor", "ros2", file}), 2, "g.json:1:2");
  expect_error(run_maide({"ros2", "import", "--graph", "/no/file.json"}), 2, "/no/file.json");
  expect_error(run_maide({"ros2", "export"}), 2, "import");
  expect_error(run_maide({"doctor", "ros1"}), 2, "ros2");
  if (!find_wrapper("ros2")) {
    expect_error(run_maide({"ros2", "import"}), 2, "the wrapper for ROS 2 is not there");
  }
}

}  // namespace
}  // namespace maide::test
