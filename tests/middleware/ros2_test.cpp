// ROS 2 for real: the answers to all words up to a length are those of the models written by hand,
// and so are those to words that tell a model from all others of its size. Over Cyclone DDS, in
// this process; over Fast DDS in one of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "ros2_cases.hpp"
#include "ros2_wrapper.hpp"

namespace maide {
namespace {

using test::SystemOptions;
using Outputs = std::vector<std::string>;

Outputs play(Sul& sul, const Word& word) {
  Outputs answer;
  const SulQuery query{word, Translation::eager};
  sul.run(std::span(&query, 1),
          [&](std::size_t, const SulAnswer& given) { answer = test::outputs(given); }, {});
  return answer;
}

class Ros2Topic : public testing::TestWithParam<test::Ros2TopicCase> {};

TEST_P(Ros2Topic, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_connection(GetParam().model);
  EXPECT_EQ(model.size(), GetParam().states);
  ros2::Ros2Wrapper wrapper;
  test::expect_answers(wrapper, GetParam().options, model, GetParam().model.reconnects ? 5 : 8);
}

TEST_P(Ros2Topic, IsToldByWordsFromOtherMachines) {
  const Mealy model = test::make_connection(GetParam().model);
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, GetParam().options);
  test::expect_answers(sul, model, test::telling_words(model));
}

INSTANTIATE_TEST_SUITE_P(Qos, Ros2Topic, testing::ValuesIn(test::ros2_topic_cases()),
                         [](const auto& tested) { return tested.param.name; });

std::unique_ptr<Sul> spawn_over(const std::string& rmw, SystemOptions options) {
  options["rmw"] = rmw;
  return spawn_wrapper({MAIDE_BINARY_DIR "/bin/maide-wrap-ros2"}, options);
}

class Ros2TopicOverFastDds : public testing::TestWithParam<test::Ros2TopicCase> {};

TEST_P(Ros2TopicOverFastDds, AnswersAllWordsAsItsModel) {
  if (!MAIDE_HAS_RMW_FASTRTPS) GTEST_SKIP() << "skipped: no rmw_fastrtps_cpp";
  const Mealy model = test::make_connection(GetParam().model);
  EXPECT_EQ(model.size(), GetParam().states);
  const auto sul = spawn_over("fastrtps", GetParam().options);
  const std::size_t length = GetParam().model.reconnects ? 5 : 8;
  test::expect_answers(*sul, model, test::all_words(model.inputs().size(), length));
}

TEST_P(Ros2TopicOverFastDds, IsToldByWordsFromOtherMachines) {
  if (!MAIDE_HAS_RMW_FASTRTPS) GTEST_SKIP() << "skipped: no rmw_fastrtps_cpp";
  const Mealy model = test::make_connection(GetParam().model);
  test::expect_answers(*spawn_over("fastrtps", GetParam().options), model,
                       test::telling_words(model));
}

INSTANTIATE_TEST_SUITE_P(Qos, Ros2TopicOverFastDds,
                         testing::ValuesIn(test::ros2_topic_cases_over_fastrtps()),
                         [](const auto& tested) { return tested.param.name; });

// The publisher keeps the newest of its own depth for whoever comes late, and the subscription has
// room for the newest of its depth. One that was there gets what fits into its own.
TEST(Ros2LateJoiner, GetsWhatBothDepthsLeave) {
  enum : Symbol { write, try_read, unsubscribe, subscribe };
  const Word late{write, write, write, unsubscribe, subscribe, try_read, try_read};
  const Word early{write, write, write, try_read, try_read, try_read, try_read};
  const auto last = [](Sul& sul, const Word& word, std::size_t count) {
    const Outputs all = play(sul, word);
    return Outputs(all.end() - static_cast<std::ptrdiff_t>(count), all.end());
  };
  std::vector<std::string> middlewares{"cyclonedds"};
  if (MAIDE_HAS_RMW_FASTRTPS) middlewares.emplace_back("fastrtps");
  for (const std::string& rmw : middlewares) {
    const auto spawn = [&](const test::Ros2Depths& depths) {
      return spawn_over(rmw, test::ros2_late_joiner("", "transient_local", 0, depths).options);
    };
    const auto short_history = spawn({1, 3}), long_history = spawn({3, 1}), same = spawn({3, 3});
    EXPECT_EQ(last(*short_history, late, 2), (Outputs{"gap", "null"})) << rmw;
    EXPECT_EQ(last(*short_history, early, 4), (Outputs{"next", "next", "next", "null"})) << rmw;
    EXPECT_EQ(last(*long_history, late, 2), (Outputs{"gap", "null"})) << rmw;
    EXPECT_EQ(last(*long_history, early, 4), (Outputs{"gap", "null", "null", "null"})) << rmw;
    EXPECT_EQ(last(*same, late, 2), (Outputs{"next", "next"})) << rmw;
  }
}

TEST(Ros2ServiceOverFastDds, AnswersAllWordsAsItsModel) {
  if (!MAIDE_HAS_RMW_FASTRTPS) GTEST_SKIP() << "skipped: no rmw_fastrtps_cpp";
  const test::Ros2ServiceCase tested{"depth_1", {1, 1, true}, {"send", "handle", "tryreceive"}, 9};
  const Mealy model = test::make_ros2_service(tested.service, tested.inputs);
  EXPECT_EQ(model.size(), tested.states);
  test::expect_answers(*spawn_over("fastrtps", tested.options()), model,
                       test::all_words(tested.inputs.size(), 6));
}

// Four messages in a queue of two or three: what one read without waiting gives.
TEST(Ros2Take, AllGivesAllAndTheOthersGiveOne) {
  for (const std::string take : {"once", "some", "direct", "all"}) {
    ros2::Ros2Wrapper wrapper;
    LocalSul sul(
        wrapper,
        {{"take", take}, {"depth", "3"}, {"inputs", "write,tryread"}, {"observe", "message,null"}});
    const Outputs answer = play(sul, {0, 0, 0, 0, 1, 1, 1, 1});
    const Outputs last(answer.begin() + 4, answer.end());
    if (take == "all") {
      EXPECT_EQ(last, (Outputs{"message,message,message", "null", "null", "null"})) << take;
    } else {
      EXPECT_EQ(last, (Outputs{"message", "message", "message", "null"})) << take;
    }
  }
}

// Ends that do not match, and Subscription::take() with rclcpp's own way through the process: never
// a message.
TEST(Ros2Topic, OfEndsThatDoNotMatchGivesNothing) {
  const std::vector<SystemOptions> cases = {
      {{"pub_reliability", "best_effort"}},
      {{"pub_reliability", "best_effort"}, {"intraprocess", "on"}},
      {{"sub_durability", "transient_local"}},
      {{"take", "direct"}, {"intraprocess", "on"}},
  };
  for (SystemOptions options : cases) {
    options["inputs"] = "write,tryread";
    options["observe"] = "message,null";
    ros2::Ros2Wrapper wrapper;
    LocalSul sul(wrapper, options);
    EXPECT_EQ(play(sul, {0, 1, 0, 1}), (Outputs{"quiet", "null", "quiet", "null"}));
  }
}

TEST(Ros2Read, WaitsForAMessage) {
  for (const std::string take : {"once", "direct"}) {
    ros2::Ros2Wrapper wrapper;
    LocalSul sul(wrapper, {{"take", take}, {"inputs", "write,read,unsubscribe,subscribe"}});
    EXPECT_EQ(play(sul, {1, 0, 0, 1}), (Outputs{"quiet", "message", "quiet", "message"})) << take;
  }
}

class Ros2ServiceRule : public testing::TestWithParam<test::Ros2ServiceCase> {};

TEST_P(Ros2ServiceRule, AnswersAllWordsAsItsModel) {
  const test::Ros2ServiceCase& tested = GetParam();
  const Mealy model = test::make_ros2_service(tested.service, tested.inputs);
  EXPECT_EQ(model.size(), tested.states);
  ros2::Ros2Wrapper wrapper;
  const std::size_t inputs = tested.inputs.size();
  test::expect_answers(wrapper, tested.options(), model, inputs == 3 ? 6 : inputs == 4 ? 5 : 4);
}

TEST_P(Ros2ServiceRule, IsToldByWordsFromOtherMachines) {
  const Mealy model = test::make_ros2_service(GetParam().service, GetParam().inputs);
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, GetParam().options());
  test::expect_answers(sul, model, test::telling_words(model));
}

INSTANTIATE_TEST_SUITE_P(Services, Ros2ServiceRule, testing::ValuesIn(test::ros2_service_cases()),
                         [](const auto& tested) { return tested.param.name; });

// The first client's answer waits in a queue that ten answers to somebody else push it out of.
TEST(Ros2Service, TenStrangersAnswersPushOneOut) {
  for (const std::size_t calls : {9, 10}) {
    ros2::Ros2Wrapper wrapper;
    LocalSul sul(wrapper, {{"kind", "service"},
                           {"clients", "2"},
                           {"burst", std::to_string(calls)},
                           {"inputs", "ask,wait,burst"}});
    EXPECT_EQ(play(sul, {0, 2, 1}),
              (Outputs{"quiet", "called", calls == 9 ? "answer" : "pending"}));
  }
}

TEST(Ros2Service, BlocksAndIsAnsweredLater) {
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper, {{"kind", "service"}});
  enum : Symbol { send, serve, answer, receive };
  EXPECT_EQ(play(sul, {serve, send, answer, receive}),
            (Outputs{"quiet", "request", "quiet", "answer"}));
}

// What is sent while there is no server is lost, and a client can ask whether there is one.
TEST(Ros2Service, ThatIsNotThereYetLosesTheRequest) {
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(
      wrapper,
      {{"kind", "service"}, {"server", "down"}, {"inputs", "send,ready,handle,tryreceive,start"}});
  enum : Symbol { send, ready, handle, try_receive, start };
  EXPECT_EQ(play(sul, {send, ready, handle, start, ready, handle, try_receive}),
            (Outputs{"quiet", "absent", "down", "quiet", "present", "none", "null"}));
}

std::string error_of(const SystemOptions& options) {
  ros2::Ros2Wrapper wrapper;
  return test::usage_error_of(wrapper, options);
}

TEST(Ros2Options, ThatMakeNoSenseAreRefused) {
  EXPECT_THAT(error_of({{"history", "keep_all"}}), testing::HasSubstr("say size=N"));
  EXPECT_EQ(error_of({{"history", "keep_all"}, {"size", "2"}}), "");
  EXPECT_THAT(error_of({{"intraprocess", "on"}, {"durability", "transient_local"}}),
              testing::HasSubstr("rclcpp refuses it"));
  EXPECT_THAT(error_of({{"intraprocess", "on"}, {"contexts", "2"}}),
              testing::HasSubstr("contexts=1"));
  EXPECT_THAT(error_of({{"inputs", "write,unsubscribe"}, {"size", "3"}}),
              testing::HasSubstr("unsubscribe loses some"));
  EXPECT_EQ(error_of({{"kind", "service"}, {"sub_depth", "3"}}),
            "option sub-depth: it means something with kind=topic only");
  EXPECT_EQ(error_of({{"clients", "2"}}),
            "option clients: it means something with kind=service only");
  EXPECT_THAT(error_of({{"kind", "service"}, {"inputs", "ask,send"}}),
              testing::HasSubstr("answer by itself"));
  EXPECT_THAT(error_of({{"kind", "service"}, {"payload", "values:a,b"}}),
              testing::HasSubstr("carry no values"));
}

TEST(Ros2Wrapper, SaysWhatItIs) {
  ros2::Ros2Wrapper wrapper;
  const LocalSul sul(wrapper, {{"kind", "service"}, {"clients", "2"}, {"payload", "gap"}});
  const SulInfo& info = sul.info();
  EXPECT_EQ(info.name, "ros2");
  EXPECT_THAT(info.versions.at("ros2"), testing::StartsWith("rclcpp "));
  EXPECT_EQ(info.actors, (Outputs{"client", "client2", "server"}));
  EXPECT_EQ(info.inputs.size(), 6U);
  EXPECT_EQ(info.inputs.at(1).returns, (Outputs{"request", "request_gap", "down"}));
}

// Wrappers side by side, and the robots on the network, must not meet; nor may a user's
// configuration change what is learned.
TEST(Ros2Wrapper, HasNoNetworkWhateverTheEnvironmentSays) {
  ::setenv("CYCLONEDDS_URI", "<General><Transport>udp</Transport></General>", 1);
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  ros2::Ros2Wrapper wrapper;
  LocalSul sul(wrapper);
  EXPECT_EQ(play(sul, {0, 1}), (Outputs{"quiet", "message"}));
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;  // the iterator's own descriptor
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    EXPECT_FALSE(target.starts_with("socket:")) << target;
  }
}

TEST(Ros2Wrapper, TriesItself) {
  ros2::Ros2Wrapper wrapper;
  EXPECT_THAT(run_self_test(wrapper), testing::EndsWith(": write -> quiet, read -> message"));
}

}  // namespace
}  // namespace maide
