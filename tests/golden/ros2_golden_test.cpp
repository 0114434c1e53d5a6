// What is made of graphs of ROS 2, byte for byte, against approved files: the graph as it is read,
// the system file, what is said of it. ros2-wide-graph.json has each remark that there is. After a
// change that is meant: MAIDE_APPROVE=1 build/dev/bin/test_golden.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/ros2/ros2_graph.hpp"

namespace maide {
namespace {

std::string findings_of(const Ros2Graph& graph) {
  constexpr std::array kinds{"no match", "no end", "loss", "late"};
  std::string text;
  for (const Ros2Finding& finding : examine_ros2_graph(graph)) {
    text += std::string(kinds.at(static_cast<std::size_t>(finding.kind))) + ": " + finding.where +
            ": " + finding.text + "\n";
  }
  return text;
}

class Ros2Golden : public testing::TestWithParam<const char*> {};

TEST_P(Ros2Golden, IsAsApproved) {
  const std::string name = GetParam();
  const Ros2Graph graph =
      read_ros2_file(MAIDE_SOURCE_DIR "/tests/systems/" + name + ".json", kept_model_path, {});
  const std::string system = write_ros2_system(graph);
  EXPECT_EQ(format_system(system, name), system);
  const Json json = ros2_graph_to_json(graph);
  EXPECT_EQ(ros2_graph_to_json(read_ros2_graph(json, name)), json);
  const std::string text = system + "\n" + findings_of(graph) + "\n" + json.dump(1) + "\n";
  const std::string path = MAIDE_SOURCE_DIR "/tests/golden/approved/" + name + ".txt.approved";
  if (std::getenv("MAIDE_APPROVE") != nullptr) write_file_atomically(path, text);
  EXPECT_EQ(text, read_file(path)) << path;
}

INSTANTIATE_TEST_SUITE_P(Graphs, Ros2Golden, testing::Values("ros2-graph", "ros2-wide-graph"),
                         [](const auto& test) {
                           std::string name = test.param;
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

}  // namespace
}  // namespace maide
