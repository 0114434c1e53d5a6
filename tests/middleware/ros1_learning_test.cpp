// ROS 1 learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// the paper's ports among them, every time the same: on a busy machine, and when the rosmaster or
// the wrapper is killed on the way.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "killed_services.hpp"
#include "maide/automata/compare.hpp"
#include "ros1_cases.hpp"

namespace maide {
namespace {

using test::SystemOptions;

class Ros1Mealy : public testing::TestWithParam<test::Ros1Case> {};

TEST_P(Ros1Mealy, IsLearned) {
  const Mealy learned = test::learn_system("ros1", GetParam().options()).machine;
  EXPECT_EQ(learned.size(), GetParam().states);
  const Mealy model = test::make_ros1_connection(GetParam().model, GetParam().inputs);
  EXPECT_FALSE(find_difference(model, learned).has_value());
}

// One of each kind: test_ros1 plays the words of all.
std::vector<test::Ros1Case> learned_cases() {
  std::vector<test::Ros1Case> cases = test::ros1_cases();
  std::erase_if(cases, [](const test::Ros1Case& tested) {
    return tested.name != "queue_gap_3" && tested.name != "burst" && tested.name != "latch" &&
           tested.name != "reconnect_intraprocess" && tested.name != "interrupt_1";
  });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Queues, Ros1Mealy, testing::ValuesIn(learned_cases()),
                         [](const auto& tested) { return tested.param.name; });

class Ros1Automaton : public testing::TestWithParam<test::PortCase> {};

TEST_P(Ros1Automaton, IsThatOfThePort) {
  test::expect_port("ros1", GetParam());
  test::expect_port("ros1", GetParam(), Translation::av);
}

INSTANTIATE_TEST_SUITE_P(
    Ports, Ros1Automaton,
    testing::Values(test::PortCase{"queue_1", {}, "buffered"},
                    test::PortCase{"unbounded_1", {{"queue_size", "0"}, {"size", "1"}}, "strict-1"},
                    test::PortCase{"unbounded_3", {{"queue_size", "0"}, {"size", "3"}}, "strict-3"},
                    test::PortCase{"unbounded_3_tryread_absorb",
                                   {{"queue_size", "0"},
                                    {"size", "3"},
                                    {"at-bound", "absorb"},
                                    {"inputs", "write,read,tryread"}},
                                   "strict-3-tryread-absorb"}),
    [](const auto& tested) { return tested.param.name; });

TEST(Ros1Killed, WrapperOrRosmasterTheModelIsTheSame) {
  const SystemOptions options{{"queue_size", "2"},
                              {"payload", "gap"},
                              {"inputs", "write,tryread"},
                              {"observe", "message,null"}};
  test::expect_same_model_when_killed(
      "ros1", options, test::make_ros1_connection({2, false, true}, {"write", "tryread"}), 6);
}

}  // namespace
}  // namespace maide
