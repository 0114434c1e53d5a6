// ROS 2 learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// the paper's ports among them.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "ros2_cases.hpp"
#include "ros2_executor_cases.hpp"

namespace maide {
namespace {

class Ros2LearnedTopic : public testing::TestWithParam<test::Ros2TopicCase> {};

TEST_P(Ros2LearnedTopic, IsTheModel) {
  const Mealy learned = test::learn_system("ros2", GetParam().options).machine;
  EXPECT_EQ(learned.size(), GetParam().states);
  EXPECT_FALSE(find_difference(test::make_connection(GetParam().model), learned).has_value());
}

// One of each kind: test_ros2 plays the words of all.
std::vector<test::Ros2TopicCase> learned_topics() {
  std::vector<test::Ros2TopicCase> cases = test::ros2_topic_cases();
  std::erase_if(cases, [](const test::Ros2TopicCase& tested) {
    return tested.name != "keep_last_2" && tested.name != "intraprocess" &&
           tested.name != "of_two_contexts";
  });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Qos, Ros2LearnedTopic, testing::ValuesIn(learned_topics()),
                         [](const auto& tested) { return tested.param.name; });

class Ros2LearnedService : public testing::TestWithParam<test::Ros2ServiceCase> {};

TEST_P(Ros2LearnedService, IsTheModel) {
  const test::Ros2ServiceCase& tested = GetParam();
  const Mealy learned = test::learn_system("ros2", tested.options()).machine;
  EXPECT_EQ(learned.size(), tested.states);
  const Mealy model = test::make_ros2_service(tested.service, tested.inputs);
  EXPECT_FALSE(find_difference(model, learned).has_value());
}

std::vector<test::Ros2ServiceCase> learned_services() {
  std::vector<test::Ros2ServiceCase> cases = test::ros2_service_cases();
  std::erase_if(cases, [](const test::Ros2ServiceCase& tested) {
    return tested.name != "depth_1" && !tested.name.starts_with("usual");
  });
  for (const std::size_t depth : {2, 5, 20}) cases.push_back(test::ros2_strangers(depth));
  return cases;
}

std::vector<test::Ros2ServiceCase> strangers_of_other_depths() {
  std::vector<test::Ros2ServiceCase> cases;
  for (std::size_t depth = 3; depth < 20; ++depth) {
    if (depth != 5) cases.push_back(test::ros2_strangers(depth));
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Services, Ros2LearnedService, testing::ValuesIn(learned_services()),
                         [](const auto& tested) { return tested.param.name; });
INSTANTIATE_TEST_SUITE_P(Wide, Ros2LearnedService, testing::ValuesIn(strangers_of_other_depths()),
                         [](const auto& tested) { return tested.param.name; });

TEST(Ros2LearnedExecutor, IsTheModel) {
  for (const test::Ros2ExecutorCase& tested : test::ros2_executor_cases()) {
    if (tested.name != "once" && tested.name != "forever" && tested.name != "timer_some" &&
        tested.name != "clients_once" && tested.name != "clients_depth_2") {
      continue;
    }
    const Mealy learned = test::learn_system("ros2", tested.options()).machine;
    EXPECT_EQ(learned.size(), tested.states) << tested.name;
    EXPECT_FALSE(find_difference(test::make_ros2_executor(tested.executor), learned).has_value())
        << tested.name;
  }
}

// A client takes one answer in its turn, whosever it is.
TEST(Ros2LearnedExecutor, IsTheModelOverFastDds) {
  if (!MAIDE_HAS_RMW_FASTRTPS) GTEST_SKIP() << "skipped: no rmw_fastrtps_cpp";
  for (const test::Ros2ExecutorCase& tested : test::ros2_executor_cases_over_fastrtps()) {
    const Mealy learned = test::learn_system("ros2", tested.options()).machine;
    EXPECT_EQ(learned.size(), tested.states) << tested.name;
    EXPECT_FALSE(find_difference(test::make_ros2_executor(tested.executor), learned).has_value())
        << tested.name;
  }
}

TEST(Ros2LearnedCall, HasTheSizeOfTheModel) {
  for (const test::Ros2NestedCase& tested : test::ros2_nested_cases()) {
    if (tested.name != "single" && tested.name != "multi_client_apart") continue;
    EXPECT_EQ(test::learn_system("ros2", tested.options()).machine.size(), tested.states)
        << tested.name;
  }
}

class Ros2Automaton : public testing::TestWithParam<test::PortCase> {};

TEST_P(Ros2Automaton, IsThatOfThePort) {
  test::expect_port("ros2", GetParam());
  test::expect_port("ros2", GetParam(), Translation::av);
}

INSTANTIATE_TEST_SUITE_P(
    Ports, Ros2Automaton,
    testing::Values(test::PortCase{"keep_last_1", {{"depth", "1"}}, "buffered"},
                    test::PortCase{
                        "keep_all_3", {{"history", "keep_all"}, {"size", "3"}}, "strict-3"}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
