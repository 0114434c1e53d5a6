// The models of ROS 2 that are kept in examples/models, so that checks need no ROS 2: they are what
// the rules say, and of the sizes that docs/middleware/ros2.md names. Needs no ROS 2 itself.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

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
  const InterfaceAutomaton expected = to_interface_automaton(rule, Translation::eager, {});
  EXPECT_TRUE(compare(expected, kept_model(name)).same()) << name;
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
}

TEST(Ros2Models, OfStrangersAreTheRule) {
  expect_kept("strangers-10", test::make_ros2_service({10, 2, false}, {"ask", "wait", "call"}));
}

struct Size {
  std::string name;
  std::size_t states;
};

void PrintTo(const Size& tested, std::ostream* out) { *out << tested.name; }

class Ros2ModelSize : public testing::TestWithParam<Size> {};

TEST_P(Ros2ModelSize, IsTheOneInTheDocs) {
  EXPECT_EQ(kept_model(GetParam().name).size(), GetParam().states);
}

INSTANTIATE_TEST_SUITE_P(Kept, Ros2ModelSize,
                         testing::Values(Size{"topic-1", 4}, Size{"topic-5", 12},
                                         Size{"topic-10", 22}, Size{"topic-12", 26},
                                         Size{"service-1", 23}, Size{"service-5", 191},
                                         Size{"service-10", 626}, Size{"nested-two-threads", 26}),
                         [](const auto& tested) {
                           std::string name = tested.param.name;
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

}  // namespace
}  // namespace maide
