// ZeroMQ learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// the paper's ports among them, every time the same, on a busy machine too.
#include <gtest/gtest.h>

#include <string>

#include "maide/automata/compare.hpp"
#include "wrapper_checks.hpp"
#include "zeromq_cases.hpp"

namespace maide {
namespace {

class ZeroMqMealy : public testing::TestWithParam<test::ZeroMqCase> {};

TEST_P(ZeroMqMealy, IsLearned) {
  const Mealy model = test::make_connection(GetParam().model);
  const Mealy learned = test::learn_system("zeromq", GetParam().options).machine;
  EXPECT_EQ(learned.size(), GetParam().states);
  EXPECT_FALSE(find_difference(model, learned).has_value());
}

INSTANTIATE_TEST_SUITE_P(Patterns, ZeroMqMealy, testing::ValuesIn(test::zeromq_cases()),
                         [](const auto& tested) { return tested.param.name; });

// zmq_send alone hears late of what its peers say; with a floor it gives the same models.
TEST(ZeroMqPlainSend, GivesTheSameModelsWithAFloor) {
  for (test::ZeroMqCase tested : test::zeromq_cases()) {
    if (tested.name != "publish_1_1" && tested.name != "push_failing_1_1") continue;
    tested.options["send"] = "plain";
    tested.options["floor"] = "3";
    const Mealy learned = test::learn_system("zeromq", tested.options).machine;
    EXPECT_EQ(learned.size(), tested.states) << tested.name;
    EXPECT_FALSE(find_difference(test::make_connection(tested.model), learned)) << tested.name;
  }
}

class ZeroMqAutomaton : public testing::TestWithParam<test::PortCase> {};

TEST_P(ZeroMqAutomaton, IsThatOfThePort) { test::expect_port("zeromq", GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Ports, ZeroMqAutomaton,
    testing::Values(
        test::PortCase{"defaults", {}, "strict-3"},
        test::PortCase{"tcp", {{"transport", "tcp"}}, "strict-3"},
        test::PortCase{"publish", {{"pattern", "pub-sub"}}, "strict-3"},
        test::PortCase{"publish_tcp", {{"pattern", "pub-sub"}, {"transport", "tcp"}}, "strict-3"},
        test::PortCase{"conflate", {{"conflate", "yes"}}, "buffered"},
        test::PortCase{"conflate_tcp", {{"conflate", "yes"}, {"transport", "tcp"}}, "buffered"},
        test::PortCase{"conflate_tryread",
                       {{"conflate", "yes"}, {"inputs", "write,read,tryread"}},
                       "buffered-tryread"},
        test::PortCase{"tryread_absorb",
                       {{"size", "3"}, {"at-bound", "absorb"}, {"inputs", "write,read,tryread"}},
                       "strict-3-tryread-absorb"}),
    [](const auto& tested) { return tested.param.name; });

class ZeroMqRepeatedly : public testing::TestWithParam<std::size_t> {};

TEST_P(ZeroMqRepeatedly, GivesTheSameModelTwentyTimes) {
  for (const test::ZeroMqCase& tested : test::zeromq_cases()) {
    if (tested.name != "publish_1_1" && tested.name != "push_1_1_reconnecting") continue;
    test::expect_same_twenty_times("zeromq", tested.options, tested.states, GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(BusyProcesses, ZeroMqRepeatedly, testing::Values(0, 2));

}  // namespace
}  // namespace maide
