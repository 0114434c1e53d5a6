// MQTT for real, with a broker that runs beside this process: the answers to all words up to a
// length are those of the models written by hand; packets come back as the standard says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "mqtt_cases.hpp"
#include "mqtt_wrapper.hpp"
#include "packets.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using testing::ElementsAre;

class Mqtt : public testing::TestWithParam<test::MqttCase> {};

TEST_P(Mqtt, AnswersAllWordsAsItsModel) {
  EXPECT_EQ(GetParam().model.size(), GetParam().states);
  mqtt::MqttWrapper wrapper;
  const std::size_t inputs = GetParam().model.inputs().size();
  test::expect_answers(wrapper, GetParam().options, GetParam().model, inputs > 2 ? 4 : 8);
}

INSTANTIATE_TEST_SUITE_P(Sessions, Mqtt, testing::ValuesIn(test::mqtt_cases()),
                         [](const auto& tested) { return tested.param.name; });

// The answers of one word, whose inputs are named by `inputs`; each once, in any order.
std::vector<std::string> answers(test::SystemOptions options,
                                 const std::vector<std::string>& word) {
  std::vector<std::string> inputs;
  for (const std::string& input : word) {
    if (std::find(inputs.begin(), inputs.end(), input) == inputs.end()) inputs.push_back(input);
  }
  for (const std::string& input : inputs) {
    options["inputs"] += (options["inputs"].empty() ? "" : ",") + input;
  }
  mqtt::MqttWrapper wrapper;
  LocalSul sul(wrapper, options);
  SulQuery query{Word(), Translation::eager};
  for (const std::string& input : word) {
    const auto place = std::find(inputs.begin(), inputs.end(), input);
    std::get<Word>(query.inputs).push_back(static_cast<Symbol>(place - inputs.begin()));
  }
  std::vector<std::string> given;
  sul.run(std::span(&query, 1),
          [&](std::size_t, const SulAnswer& answer) { given = test::outputs(answer); }, {});
  return given;
}

TEST(MqttConnection, OfQos0LosesNothing) {
  std::vector<std::string> word(200, "write"), expected(200, "quiet");
  word.insert(word.end(), 201, "tryread");
  expected.insert(expected.end(), 200, "next");
  expected.emplace_back("null");
  EXPECT_EQ(answers({{"size", "200"}, {"payload", "gap"}, {"observe", "message,null"}}, word),
            expected);
}

// mosquitto's defaults: 20 in flight and 1000 queued; the publisher is told "acknowledged" all
// along.
TEST(MqttConnection, OfQos1Keeps1020MessagesAndDropsTheNewest) {
  std::vector<std::string> word(1025, "write"), expected(1025, "written");
  word.insert(word.end(), 1021, "tryread");
  expected.insert(expected.end(), 1020, "next");
  expected.emplace_back("null");
  word.insert(word.end(), {"write", "tryread"});
  expected.insert(expected.end(), {"written", "gap"});
  EXPECT_EQ(
      answers(
          {{"qos", "1"}, {"size", "0"}, {"payload", "gap"}, {"observe", "message,null,written"}},
          word),
      expected);
}

TEST(MqttConnection, OfASessionThatTheBrokerForgetsLosesAll) {
  EXPECT_THAT(
      answers({{"qos", "1"}, {"observe", "message,null,offline,connected,disconnected"}},
              {"write", "disconnect", "read", "write", "connect", "tryread", "write", "tryread"}),
      ElementsAre("quiet", "disconnected", "offline", "quiet", "connected", "null", "quiet",
                  "message"));
}

TEST(MqttConnection, OfAPersistentSessionKeepsQos1AndDropsQos0) {
  const std::vector<std::string> word{"disconnect", "write", "connect", "tryread"};
  EXPECT_THAT(answers({{"qos", "1"}, {"session", "persistent"}, {"observe", "message,null"}}, word),
              ElementsAre("quiet", "quiet", "quiet", "message"));
  EXPECT_THAT(answers({{"qos", "0"}, {"session", "persistent"}, {"observe", "message,null"}}, word),
              ElementsAre("quiet", "quiet", "quiet", "null"));
}

// What was sent and not read before the connection broke is sent again, in its place.
TEST(MqttConnection, ThatBreaksDoesNotLoseWhatWasNotAcknowledged) {
  EXPECT_THAT(
      answers({{"qos", "1"},
               {"session", "persistent"},
               {"payload", "gap"},
               {"observe", "message,null"}},
              {"write", "write", "tryread", "drop", "write", "connect", "tryread", "tryread",
               "tryread"}),
      ElementsAre("quiet", "quiet", "next", "quiet", "quiet", "quiet", "next", "next", "null"));
}

TEST(MqttConnection, WithRetainedMessagesGivesTheLastOneAgain) {
  EXPECT_THAT(answers({{"retain", "yes"}, {"payload", "gap"}, {"observe", "message,null"}},
                      {"write", "write", "tryread", "tryread", "disconnect", "connect", "tryread",
                       "tryread"}),
              ElementsAre("quiet", "quiet", "next", "next", "quiet", "quiet", "old", "null"));
}

TEST(MqttConnection, TellsTheReaderOfAWriterThatBreaks) {
  const test::SystemOptions options{{"will", "yes"},
                                    {"observe", "message,null,will,failed,writer_connected"}};
  EXPECT_THAT(
      answers(options, {"writer_drop", "tryread", "write", "writer_connect", "write", "tryread"}),
      ElementsAre("quiet", "will", "failed", "writer_connected", "quiet", "message"));
  EXPECT_THAT(answers(options, {"writer_disconnect", "tryread"}), ElementsAre("quiet", "null"));
}

TEST(MqttProtocol, AnswersWithPackets) {
  EXPECT_THAT(answers({{"alphabet", "protocol"}},
                      {"connect", "ping", "publish_qos0", "publish_qos1", "publish_qos2", "pubrel",
                       "subscribe", "publish_qos0", "publish_qos1", "unsubscribe", "publish_qos1",
                       "invalid", "ping", "connect", "disconnect"}),
              ElementsAre("connack", "pingresp", "quiet", "puback", "pubrec", "pubcomp", "suback",
                          "message_qos0", "message_qos1,puback", "unsuback", "puback", "closed",
                          "closed", "connack", "closed"));
}

TEST(MqttProtocol, HasHandshakesOfQos2BothWays) {
  EXPECT_THAT(answers({{"alphabet", "protocol"}, {"qos", "2"}},
                      {"connect", "subscribe", "publish_qos2", "publish_qos2", "pubrel", "pubrel"}),
              ElementsAre("connack", "suback", "pubrec", "pubrec", "message_qos2,pubcomp,pubrel",
                          "pubcomp"));
}

TEST(MqttProtocol, KeepsRetainedMessagesAndSessions) {
  EXPECT_THAT(answers({{"alphabet", "protocol"}, {"session", "persistent"}, {"qos", "1"}},
                      {"connect", "publish_retained_b", "subscribe_b", "drop", "connect",
                       "delete_retained_b", "unsubscribe_b", "subscribe_b"}),
              ElementsAre("connack", "puback", "suback,message_retained_b", "closed",
                          "connack_present", "message_empty_b,puback", "unsuback", "suback"));
}

TEST(MqttProtocol, PublishesTheWillOfAClientThatGoesWithoutAWord) {
  const test::SystemOptions options{{"alphabet", "protocol"}, {"clients", "2"}};
  EXPECT_THAT(answers(options, {"c2_connect", "c2_subscribe", "connect_will", "drop"}),
              ElementsAre("c2_connack", "c2_suback", "connack", "closed,c2_message_will"));
  EXPECT_THAT(answers(options, {"c2_connect", "c2_subscribe", "connect_will", "disconnect"}),
              ElementsAre("c2_connack", "c2_suback", "connack", "closed"));
  EXPECT_THAT(answers(options, {"connect_will_retain", "drop", "c2_connect", "c2_subscribe"}),
              ElementsAre("connack", "closed", "c2_connack", "c2_suback,c2_message_will"));
}

std::string error_of(const test::SystemOptions& options) {
  mqtt::MqttWrapper wrapper;
  return test::usage_error_of(wrapper, options);
}

TEST(MqttOptions, ThatMakeNoSenseAreRefused) {
  EXPECT_THAT(error_of({{"size", "0"}}), testing::HasSubstr("say size=N"));
  EXPECT_THAT(error_of({{"size", "0"}, {"qos", "1"}, {"max-queued", "0"}}),
              testing::HasSubstr("say size=N"));
  EXPECT_EQ(error_of({{"size", "0"}, {"qos", "1"}, {"max-queued", "1"}}), "");
  EXPECT_THAT(error_of({{"alphabet", "protocol"}, {"payload", "gap"}}),
              testing::StartsWith("option payload:"));
  EXPECT_THAT(error_of({{"clients", "2"}}), testing::StartsWith("option clients:"));
  EXPECT_THAT(error_of({{"inputs", "write,ping"}}), testing::HasSubstr("there is no input 'ping'"));
  EXPECT_THAT(error_of({{"inputs", "usual,read"}}), testing::HasSubstr("no input 'usual'"));
  EXPECT_THAT(error_of({{"broker", "127.0.0.1:1"}, {"max-queued", "1"}}),
              testing::HasSubstr("broker=HOST:PORT"));
  EXPECT_THAT(error_of({{"broker", "127.0.0.1:0"}}), testing::HasSubstr("is not a port"));
  EXPECT_THAT(error_of({{"observe", "null"}}), testing::HasSubstr("'message' must be observed"));
}

TEST(MqttWrapper, SaysWhatItIs) {
  mqtt::MqttWrapper wrapper;
  const LocalSul sul(wrapper);
  EXPECT_EQ(sul.info().name, "mqtt");
  EXPECT_THAT(sul.info().versions.at("mqtt"), testing::StartsWith("mosquitto "));
  EXPECT_EQ(sul.info().actors, (std::vector<std::string>{"writer", "reader"}));
  EXPECT_EQ(sul.info().inputs.size(), 2u);
  EXPECT_EQ(sul.info().bound, "at most 3 messages in flight");
}

TEST(MqttWrapper, TriesItself) {
  mqtt::MqttWrapper wrapper;
  EXPECT_THAT(run_self_test(wrapper), testing::EndsWith(": write -> quiet, read -> message"));
}

TEST(MqttPackets, AreTakenOutOfAStreamOnceTheyAreWhole) {
  const std::string payload(300, 'x');
  const std::string first = mqtt::encode_publish({"topic", payload, 1, true, 0x1234});
  const std::string stream = first + mqtt::encode_empty(mqtt::PacketType::pingreq);
  std::string bytes;
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    bytes += stream[i];
    ASSERT_FALSE(mqtt::take_packet(bytes).has_value()) << i;
  }
  bytes = stream;
  const auto packet = mqtt::take_packet(bytes);
  ASSERT_TRUE(packet.has_value());
  const mqtt::Publication publication = mqtt::parse_publication(*packet);
  EXPECT_EQ(publication.topic, "topic");
  EXPECT_EQ(publication.payload, payload);
  EXPECT_EQ(publication.qos, 1);
  EXPECT_EQ(publication.id, 0x1234);
  EXPECT_TRUE(publication.retain);
  const auto ping = mqtt::take_packet(bytes);
  ASSERT_TRUE(ping.has_value());
  EXPECT_EQ(ping->type, mqtt::PacketType::pingreq);
  EXPECT_FALSE(mqtt::take_packet(bytes).has_value());
}

TEST(MqttPackets, ThatAreNoneAreRefused) {
  std::string bytes = "\x30\xff\xff\xff\xff\x01";
  EXPECT_THROW(mqtt::take_packet(bytes), std::runtime_error);
  bytes = std::string("\x32\x04\x00\x05to", 6);
  const auto packet = mqtt::take_packet(bytes);
  ASSERT_TRUE(packet.has_value());
  EXPECT_THROW(mqtt::parse_publication(*packet), std::runtime_error);
}

}  // namespace
}  // namespace maide
