// The models of ROS 2 that are kept in examples/models, so that checks need no ROS 2: they are what
// the rules say. Needs no ROS 2 itself.
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <string>

#include "maide/automata/compare.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "ros2_executor_model.hpp"
#include "ros2_model.hpp"

namespace maide {
namespace {

InterfaceAutomaton kept_model(const std::string& name) {
  return read_interface_automaton(MAIDE_SOURCE_DIR "/examples/models/ros2-" + name + ".dot");
}

void expect_kept(const std::string& name, const Mealy& rule) {
  const InterfaceAutomaton kept = kept_model(name);
  const InterfaceAutomaton expected = to_interface_automaton(rule, Translation::eager, kept.actors);
  EXPECT_TRUE(compare(expected, kept).same()) << name;
}

TEST(Ros2Models, OfExecutorsAreTheRules) {
  expect_kept("executor-once", test::make_ros2_executor({}));
  expect_kept("executor-some", test::make_ros2_executor({2, 0, 0, 1, 1, "some"}));
  expect_kept("executor-timer", test::make_ros2_executor({2, 1, 0}));
  expect_kept("executor-single", test::make_ros2_executor({2, 0, 0, 1, 1, "forever"}));
  expect_kept("executor-multi", test::make_ros2_executor({2, 0, 0, 1, 2, "forever"}));
  expect_kept("executor-reentrant",
              test::make_ros2_executor({2, 0, 0, 1, 2, "forever", "reentrant"}));
}

TEST(Ros2Models, OfCallsAreTheRules) {
  expect_kept("nested-single", test::make_ros2_nested({}));
  expect_kept("nested-client-apart", test::make_ros2_nested({2, 1, "a", "b"}));
  const std::string any = "reentrant";
  expect_kept("nested-two-threads", test::make_ros2_nested({2, 2, any, any, any}));
}

TEST(Ros2Models, OfStrangersAreTheRule) {
  expect_kept("strangers-10", test::make_ros2_service({10, 2, false}, {"ask", "wait", "call"}));
}

TEST(Ros2Models, OfTopicsAreTheRule) {
  for (const std::size_t depth : {1, 5, 10, 12}) {
    const Mealy rule = test::make_ros2_topic(depth);
    EXPECT_EQ(rule.size(), depth + 2);
    expect_kept("topic-" + std::to_string(depth), rule);
  }
}

// The sizes are those of docs/middleware/ros2.md.
TEST(Ros2Models, OfServicesAreTheRule) {
  const std::map<std::size_t, std::size_t> sizes{{1, 15}, {5, 91}, {10, 276}};
  for (const auto& [depth, states] : sizes) {
    const Mealy rule = test::make_ros2_service({depth}, {"send", "serve", "answer", "receive"});
    EXPECT_EQ(rule.size(), states);
    expect_kept("service-" + std::to_string(depth), rule);
  }
}

}  // namespace
}  // namespace maide
