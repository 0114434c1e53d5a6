// ROS 2 gives the same model every time, on a busy machine too.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

#include "ros2_cases.hpp"
#include "ros2_executor_cases.hpp"

namespace maide {
namespace {

struct Case {
  std::string name;
  test::SystemOptions options;
  std::size_t states;
};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }

using Repeated = std::tuple<Case, std::size_t>;

class Ros2Repeatedly : public testing::TestWithParam<Repeated> {};

TEST_P(Ros2Repeatedly, GivesTheSameModelTwentyTimes) {
  const auto& [tested, busy_processes] = GetParam();
  test::expect_same_twenty_times("ros2", tested.options, tested.states, busy_processes);
}

std::vector<Case> cases() {
  std::vector<Case> chosen;
  for (const test::Ros2TopicCase& each : test::ros2_topic_cases()) {
    if (each.name == "keep_last_2") chosen.push_back({each.name, each.options, each.states});
  }
  for (const test::Ros2ServiceCase& each : test::ros2_service_cases()) {
    if (each.name == "depth_1") chosen.push_back({"service", each.options(), each.states});
  }
  for (const test::Ros2ExecutorCase& each : test::ros2_executor_cases()) {
    if (each.name == "once") chosen.push_back({"executor", each.options(), each.states});
  }
  for (const test::Ros2NestedCase& each : test::ros2_nested_cases()) {
    if (each.name == "multi_reentrant") {
      chosen.push_back({"nested", each.options(), each.states});
    }
  }
  return chosen;
}

INSTANTIATE_TEST_SUITE_P(Kinds, Ros2Repeatedly,
                         testing::Combine(testing::ValuesIn(cases()), testing::Values(0, 2)),
                         [](const testing::TestParamInfo<Repeated>& info) {
                           return std::get<0>(info.param).name + "_busy_" +
                                  std::to_string(std::get<1>(info.param));
                         });

}  // namespace
}  // namespace maide
