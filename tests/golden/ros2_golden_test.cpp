// What is made of graphs of ROS 2, byte for byte, against approved files: the graph as it is read,
// the system file, what is said of it. ros2-wide-graph.json has each remark that there is. After a
// change that is meant: MAIDE_APPROVE=1 build/dev/bin/test_golden.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "approved.hpp"
#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/ros2/replayed_nodes.hpp"
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
  test::expect_approved(name + ".txt", text);
}

INSTANTIATE_TEST_SUITE_P(Graphs, Ros2Golden, testing::Values("ros2-graph", "ros2-wide-graph"),
                         [](const auto& test) {
                           std::string name = test.param;
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

// ---- Nodes that are replayed ----

// What the wrapper is told of the nodes of an example, and asked on a run to its deadlock.
class ReplayedGolden : public testing::TestWithParam<const char*> {};

TEST_P(ReplayedGolden, IsAsApproved) {
  const std::filesystem::path file = MAIDE_SOURCE_DIR "/examples/ros2/" + std::string(GetParam());
  const System system = read_system(file, read_requested_model, {}, {}, Deliveries::at_rest);
  const std::vector<std::string> options{"kind=topic", "depth=10", "pub-reliability=reliable"};
  const std::vector<SystemSpec> topics(system.topics.size(), parse_system_spec("ros2", options));
  const ReplayedNodes nodes(system, topics);
  std::string text = nodes.spec().text + "\n";
  for (const auto& [key, value] : nodes.spec().options) text += key + "=" + value + "\n";
  text += "models:";
  for (const std::uint32_t model : nodes.models()) text += " " + system.models[model].name;
  text += "\n";
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"deadlock"};
  request.options.threads = 1;
  const PropertyResult result = check_system(system, engine, request).properties.front();
  if (result.trace) {
    std::vector<std::size_t> moves(result.trace->steps.size());
    std::iota(moves.begin(), moves.end(), 0);
    const auto calls = nodes.plan(*result.trace, replay(system, *result.trace).back(), moves);
    const auto tell = [&](const ReplayedNodes::Call& call) {
      text += "  " + call.input + ", which is " + nodes.describe(call.input);
      for (const std::string& event : call.expected) {
        text += " -> " + event + ", which is " + nodes.describe(event);
        const auto output = nodes.output_of(event);
        if (output) text += " of " + system.models[output->model].name + "!" + output->name;
      }
      text += "\n";
    };
    for (std::size_t step = 0; step < calls.moves.size(); ++step) {
      text += "step " + std::to_string(step) + "\n";
      for (const auto& call : calls.moves[step]) tell(call);
    }
    text += "at the end\n";
    for (const auto& call : calls.end) tell(call);
  }
  test::expect_approved(file.stem().string() + ".replayed.txt", text);
}

INSTANTIATE_TEST_SUITE_P(Nodes, ReplayedGolden,
                         testing::Values("nested/nested.yaml", "nested/reentrant.yaml",
                                         "late-server/late-server.yaml", "burst/burst-nodes.yaml",
                                         "snapshot/snapshot.yaml", "camera/camera.yaml"),
                         [](const auto& test) {
                           std::string name = std::filesystem::path(test.param).stem().string();
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

}  // namespace
}  // namespace maide
