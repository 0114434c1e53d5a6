// ROS 2 gives the same model every time, on a busy machine too.
#include <gtest/gtest.h>

#include <cstddef>
#include <set>
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

// The machines of docs/middleware/ros2.md, up to 81 states; of each kind, one at rest, too.
std::vector<Repeated> cases() {
  const std::set<std::string> topics{"keep_last_1", "keep_last_2",    "keep_last_3",
                                     "spin_some",   "intraprocess",   "of_two_contexts",
                                     "volatile",    "transient_local"};
  const std::set<std::string> services{"depth_1", "depth_2", "restarted", "two_clients_gap",
                                       "strangers_10"};
  const std::set<std::string> executors{"once", "some", "timer_once", "timer_some", "clients_once"};
  const std::set<std::string> calls{"single", "multi_reentrant"};
  std::vector<Case> chosen;
  for (const test::Ros2TopicCase& each : test::ros2_topic_cases()) {
    if (topics.contains(each.name)) chosen.push_back({each.name, each.options, each.states});
  }
  for (const test::Ros2ServiceCase& each : test::ros2_service_cases()) {
    if (!services.contains(each.name)) continue;
    chosen.push_back({"service_" + each.name, each.options(), each.states});
  }
  for (const test::Ros2ExecutorCase& each : test::ros2_executor_cases()) {
    if (!executors.contains(each.name)) continue;
    chosen.push_back({"executor_" + each.name, each.options(), each.states});
  }
  for (const test::Ros2NestedCase& each : test::ros2_nested_cases()) {
    if (!calls.contains(each.name)) continue;
    chosen.push_back({"nested_" + each.name, each.options(), each.states});
  }
  const std::set<std::string> at_rest{"keep_last_2", "service_depth_1", "executor_once",
                                      "nested_multi_reentrant"};
  std::vector<Repeated> all;
  for (const Case& each : chosen) {
    all.emplace_back(each, 2);
    if (at_rest.contains(each.name)) all.emplace_back(each, 0);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Kinds, Ros2Repeatedly, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Repeated>& info) {
                           return std::get<0>(info.param).name + "_busy_" +
                                  std::to_string(std::get<1>(info.param));
                         });

}  // namespace
}  // namespace maide
