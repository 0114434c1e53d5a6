// Executors of ROS 2 for real, in this process: the answers to all words up to a length are those
// of one rule, and the rule's machines have the sizes that were worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "maide/wire/wrapper/wrapper_session.hpp"
#include "ros2_executor_cases.hpp"
#include "ros2_wrapper.hpp"

namespace maide {
namespace {

using Outputs = std::vector<std::string>;

// The inputs by name.
Outputs play(Sul& sul, const std::vector<std::string>& names) {
  Word word;
  for (const std::string& name : names) {
    const auto& inputs = sul.info().inputs;
    const auto input = std::find_if(inputs.begin(), inputs.end(),
                                    [&](const SulInput& each) { return each.name == name; });
    word.push_back(static_cast<Symbol>(input - inputs.begin()));
  }
  Outputs answer;
  const SulQuery query{word, Translation::eager};
  sul.run(std::span(&query, 1),
          [&](std::size_t, const SulAnswer& given) { answer = test::outputs(given); }, {});
  return answer;
}

// The longest words of which there are at most 1,500.
std::size_t length_for(std::size_t inputs) {
  std::size_t length = 0;
  for (std::size_t words = inputs; words <= 1500; words *= inputs) ++length;
  return length;
}

class Ros2ExecutorRule : public testing::TestWithParam<test::Ros2ExecutorCase> {};

TEST_P(Ros2ExecutorRule, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_ros2_executor(GetParam().executor);
  EXPECT_EQ(model.size(), GetParam().states);
  ros2::Ros2Wrapper wrapper;
  test::expect_answers(wrapper, GetParam().options(), model, length_for(model.inputs().size()));
}

TEST_P(Ros2ExecutorRule, IsToldByWordsFromOtherMachines) {
  const Mealy model = test::make_ros2_executor(GetParam().executor);
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, GetParam().options());
  test::expect_answers(sul, model, test::telling_words(model));
}

INSTANTIATE_TEST_SUITE_P(Executors, Ros2ExecutorRule,
                         testing::ValuesIn(test::ros2_executor_cases()),
                         [](const auto& tested) { return tested.param.name; });

class Ros2NestedCall : public testing::TestWithParam<test::Ros2NestedCase> {};

TEST_P(Ros2NestedCall, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_ros2_nested(GetParam().nested);
  EXPECT_EQ(model.size(), GetParam().states);
  ros2::Ros2Wrapper wrapper;
  test::expect_answers(wrapper, GetParam().options(), model, length_for(model.inputs().size()));
}

TEST_P(Ros2NestedCall, ReturnsOrHangsAsTheTableSays) {
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, GetParam().options());
  const Outputs answer = play(sul, {"trigger1", "call1", "look"});
  const std::string ended = GetParam().nested.spins ? "exception1" : "returned1";
  EXPECT_EQ(answer, GetParam().hangs ? (Outputs{"began1", "quiet", "hangs"})
                                     : (Outputs{"began1", ended, "idle"}));
}

INSTANTIATE_TEST_SUITE_P(Calls, Ros2NestedCall, testing::ValuesIn(test::ros2_nested_cases()),
                         [](const auto& tested) { return tested.param.name; });

// The snapshot of what is ready outlives the call that took it.
TEST(Ros2Executor, RunsWhatItSawBeforeWhatCameSince) {
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, {{"kind", "executor"}, {"depth", "1"}});
  EXPECT_EQ(play(sul, {"arrive1", "arrive2", "spin", "arrive1", "spin", "spin", "spin"}),
            (Outputs{"quiet", "quiet", "sub1", "quiet", "sub2", "sub1", "nothing"}));
}

TEST(Ros2Executor, RunsSubscriptionsAfterServicesWithIntraprocess) {
  for (const std::string intraprocess : {"off", "on"}) {
    ros2::Ros2Wrapper wrapper;
    LocalSul sul(wrapper, {{"kind", "executor"},
                           {"timers", "1"},
                           {"services", "1"},
                           {"spin", "some"},
                           {"intraprocess", intraprocess}});
    const Outputs answer = play(sul, {"request1", "arrive2", "arrive1", "due1", "spin"});
    EXPECT_EQ(answer.back(),
              intraprocess == "off" ? "timer1,sub1,sub2,service1" : "timer1,service1,sub1,sub2");
  }
}

// Two callbacks that were "fixed" by a reentrant group and two threads wait for each other's
// thread.
TEST(Ros2Nested, TwoCallsOnTwoThreadsBlockUntilOneGivesUp) {
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, {{"kind", "nested"},
                         {"executor", "multi"},
                         {"callers", "2"},
                         {"caller_group", "reentrant"},
                         {"client_group", "reentrant"},
                         {"server_group", "reentrant"}});
  EXPECT_EQ(
      play(sul, {"trigger1", "trigger2", "call1", "look", "call2", "look", "timeout1"}),
      (Outputs{"began1", "began2", "quiet", "waits", "quiet", "hangs", "timed_out1,returned2"}));
}

std::string error_of(const test::SystemOptions& options) {
  ros2::Ros2Wrapper wrapper;
  return test::usage_error_of(wrapper, options);
}

TEST(Ros2ExecutorOptions, ThatMakeNoSenseAreRefused) {
  EXPECT_THAT(error_of({{"kind", "executor"}, {"subscriptions", "0"}}),
              testing::HasSubstr("without callbacks"));
  EXPECT_EQ(error_of({{"kind", "executor"}, {"subscriptions", "0"}, {"timers", "1"}}), "");
  EXPECT_EQ(error_of({{"kind", "nested"}, {"timers", "1"}}),
            "option timers: it means something with kind=executor only");
  EXPECT_EQ(error_of({{"kind", "topic"}, {"threads", "4"}}),
            "option threads: it means something with kind=executor, nested only");
  EXPECT_THAT(error_of({{"kind", "executor"}, {"inputs", "arrive3"}}),
              testing::HasSubstr("there is no input 'arrive3'"));
}

}  // namespace
}  // namespace maide
