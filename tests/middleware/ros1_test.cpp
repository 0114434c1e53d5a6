// ROS 1 for real, in this process and with a rosmaster of its own: the answers to all words up to a
// length are those of the models written by hand, and those models have the sizes that theory
// gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "ros1_cases.hpp"
#include "ros1_wrapper.hpp"

namespace maide {
namespace {

std::vector<std::string> play(Sul& sul, const Word& word) {
  std::vector<std::string> answer;
  const SulQuery query{word, Translation::eager};
  sul.run(std::span(&query, 1),
          [&](std::size_t, const SulAnswer& given) { answer = test::outputs(given); }, {});
  return answer;
}

class Ros1 : public testing::TestWithParam<test::Ros1Case> {};

TEST_P(Ros1, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_ros1_connection(GetParam().model, GetParam().inputs);
  EXPECT_EQ(model.size(), GetParam().states);
  ros1::Ros1Wrapper wrapper;
  const std::size_t inputs = GetParam().inputs.size();
  test::expect_answers(wrapper, GetParam().options(), model, inputs == 2 ? 8 : inputs == 3 ? 6 : 5);
}

INSTANTIATE_TEST_SUITE_P(Queues, Ros1, testing::ValuesIn(test::ros1_cases()),
                         [](const auto& tested) { return tested.param.name; });

// A blocked read is woken by a message, by one that was latched, and by an interrupt.
TEST(Ros1Read, WaitsUntilThereIsSomething) {
  ros1::Ros1Wrapper wrapper;
  LocalSul sul(wrapper, {{"inputs", "write,read,disconnect,connect,interrupt,resume"},
                         {"latch", "true"},
                         {"observe", "message,failed"}});
  enum : Symbol { write, read, disconnect, connect, interrupt, resume };
  using Outputs = std::vector<std::string>;
  EXPECT_EQ(play(sul, {read, write, read, write}),
            (Outputs{"quiet", "message", "quiet", "message"}));
  EXPECT_EQ(play(sul, {write, disconnect, read, connect}),
            (Outputs{"quiet", "quiet", "quiet", "message"}));
  EXPECT_EQ(play(sul, {read, interrupt, resume, write, read}),
            (Outputs{"quiet", "failed", "quiet", "quiet", "message"}));
  EXPECT_EQ(play(sul, {read, disconnect, write, connect}),
            (Outputs{"quiet", "quiet", "quiet", "message"}));
}

// Messages that came while the callback queue was disabled are kept without a callback, so a full
// queue stays full for ever: no later message gets one either.
TEST(Ros1Interrupt, OfAFullQueueMakesTheSubscriberDeaf) {
  ros1::Ros1Wrapper wrapper;
  LocalSul sul(wrapper, {{"queue_size", "2"},
                         {"inputs", "write,tryread,interrupt,resume"},
                         {"observe", "message,null,failed"}});
  enum : Symbol { write, try_read, interrupt, resume };
  const std::vector<std::string> answer =
      play(sul, {interrupt, write, write, resume, write, try_read, write, try_read});
  EXPECT_EQ(answer[5], "null");
  EXPECT_EQ(answer[7], "null");
}

// The publisher's queue holds one message while a burst goes through it; which ones get through is
// a matter of luck, but the last one always does.
TEST(Ros1Burst, ThroughAShortPublisherQueueKeepsTheNewest) {
  ros1::Ros1Wrapper wrapper;
  LocalSul sul(wrapper, {{"pub_queue_size", "1"},
                         {"sub_queue_size", "1"},
                         {"burst", "100"},
                         {"inputs", "burst,tryread"},
                         {"observe", "message,null"},
                         {"payload", "gap"}});
  for (int word = 0; word < 50; ++word) {
    EXPECT_EQ(play(sul, {0, 1, 1}), (std::vector<std::string>{"quiet", "gap", "null"}));
  }
}

std::string error_of(const test::SystemOptions& options) {
  ros1::Ros1Wrapper wrapper;
  return test::usage_error_of(wrapper, options);
}

TEST(Ros1Options, ThatMakeNoSenseAreRefused) {
  EXPECT_THAT(error_of({{"queue_size", "0"}}), testing::HasSubstr("say size=N"));
  EXPECT_EQ(error_of({{"queue_size", "0"}, {"size", "3"}}), "");
  EXPECT_EQ(error_of({{"queue_size", "0"}, {"sub_queue_size", "2"}}), "");
  EXPECT_THAT(error_of({{"queue_size", "0"}, {"size", "3"}, {"inputs", "write,read,disconnect"}}),
              testing::HasSubstr("cannot be counted with the input disconnect"));
  EXPECT_THAT(error_of({{"master", "http://127.0.0.1:1/"}}), testing::HasSubstr("option master"));
}

TEST(Ros1Wrapper, SaysWhatItIs) {
  ros1::Ros1Wrapper wrapper;
  const LocalSul sul(wrapper, {{"payload", "gap"}, {"inputs", "write,read,connect"}});
  const SulInfo& info = sul.info();
  EXPECT_EQ(info.name, "ros1");
  EXPECT_FALSE(info.versions.at("ros1").empty());
  EXPECT_EQ(info.actors, (std::vector<std::string>{"writer", "reader", "network"}));
  EXPECT_EQ(info.inputs.at(1).returns, (std::vector<std::string>{"next", "gap"}));
  EXPECT_EQ(info.bound, "");
}

TEST(Ros1Wrapper, TriesItself) {
  ros1::Ros1Wrapper wrapper;
  EXPECT_THAT(run_self_test(wrapper), testing::EndsWith(": write -> quiet, read -> message"));
}

}  // namespace
}  // namespace maide
