// Fast DDS for real, in this process: the answers to all words up to a length are those of the
// models written by hand, and those models have the sizes that theory gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "fastdds_cases.hpp"
#include "fastdds_wrapper.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

class FastDds : public testing::TestWithParam<test::CycloneDdsCase> {};

TEST_P(FastDds, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_connection(GetParam().model);
  EXPECT_EQ(model.size(), GetParam().states);
  fastdds::FastDdsWrapper wrapper;
  std::size_t length = GetParam().model.reconnects ? 6 : 9;
  if (GetParam().options.contains("transport")) length -= 2;  // steps of 20 ms
  test::expect_answers(wrapper, GetParam().options, model, length);
}

INSTANTIATE_TEST_SUITE_P(Policies, FastDds, testing::ValuesIn(test::fastdds_cases()),
                         [](const auto& tested) { return tested.param.name; });

INSTANTIATE_TEST_SUITE_P(Network, FastDds, testing::ValuesIn(test::fastdds_udp_cases()),
                         [](const auto& tested) { return tested.param.name; });

// Outputs of one word over write, read, tryread.
std::vector<std::string> play(const test::SystemOptions& options, const Word& word) {
  fastdds::FastDdsWrapper wrapper;
  LocalSul sul(wrapper, options);
  std::vector<std::string> answer;
  const SulQuery query{word, Translation::eager};
  sul.run(std::span(&query, 1),
          [&](std::size_t, const SulAnswer& given) { answer = test::outputs(given); }, {});
  return answer;
}

// The shortest word that shows it, with the protocol's own timers too: reliable, and yet the second
// message never arrives, nor can anything be written from then on.
// A depth is each end's own, and ends that do not match never meet.
TEST(FastDdsEnds, HaveQosOfTheirOwn) { test::expect_qos_of_each_end<fastdds::FastDdsWrapper>(); }

TEST(FastDdsDefect, WhatAFullReaderRefusedNeverArrives) {
  for (const char* timers : {"short", "default"}) {
    const auto answer = play({{"history", "keep_all"},
                              {"max-samples", "1"},
                              {"reliability", "reliable"},
                              {"max-blocking-time", "0"},
                              {"inputs", "write,tryread"},
                              {"observe", "message,null,written,failed"},
                              {"timers", timers}},
                             {0, 0, 1, 1, 0, 1});
    EXPECT_EQ(answer, (std::vector<std::string>{"written", "written", "message", "null", "failed",
                                                "null"}));
  }
}

// A reliable reader with a limit that comes after something was written: neither what was written
// before nor anything after arrives within the process; over UDP what comes after does.
TEST(FastDdsDefect, ALateReaderWithALimitGetsNothing) {
  for (const char* transport : {"none", "udp"}) {
    const auto answer = play({{"history", "keep_all"},
                              {"max-samples", "1"},
                              {"reliability", "reliable"},
                              {"inputs", "write,tryread,disconnect,connect"},
                              {"observe", "message,null,written"},
                              {"transport", transport}},
                             {0, 2, 3, 0, 1});
    EXPECT_EQ(answer,
              (std::vector<std::string>{"written", "quiet", "quiet", "written",
                                        std::string(transport) == "none" ? "null" : "message"}));
  }
}

TEST(FastDdsWrapper, SaysWhatItIs) {
  fastdds::FastDdsWrapper wrapper;
  const LocalSul sul(wrapper, {{"history", "keep_all"},
                               {"max-samples", "2"},
                               {"reliability", "reliable"},
                               {"durability", "transient_local"},
                               {"inputs", "write,read,disconnect"},
                               {"payload", "gap"}});
  const SulInfo& info = sul.info();
  EXPECT_EQ(info.name, "fastdds");
  EXPECT_FALSE(info.versions.at("fastdds").empty());
  EXPECT_EQ(info.actors, (std::vector<std::string>{"writer", "reader"}));
  EXPECT_EQ(info.inputs.at(0).returns, std::vector<std::string>{"written"});
  EXPECT_EQ(info.inputs.at(1).returns,
            (std::vector<std::string>{"next", "gap", "old", "unconnected"}));
  EXPECT_EQ(info.options.at("floor"), "0");
  const LocalSul network(
      wrapper,
      {{"transport", "udp"}, {"reliability", "reliable"}, {"durability", "transient_local"}});
  EXPECT_EQ(network.info().options.at("floor"), "20");
}

// A blocked write and a waiting read at once, with nothing on the way: the word still ends.
TEST(FastDdsWrapper, EndsAWordWhoseCallsBothBlock) {
  const test::SystemOptions options{
      {"history", "keep_all"}, {"max-samples", "1"}, {"reliability", "reliable"}};
  EXPECT_EQ(play(options, {0, 0, 1, 0, 1}),
            (std::vector<std::string>{"quiet", "quiet", "message", "quiet", "quiet"}));
}

// Neither a user's profiles nor a discovery server may change what is learned.
TEST(FastDdsWrapper, DoesNotHeedTheEnvironment) {
  const std::filesystem::path profiles =
      std::filesystem::path(testing::TempDir()) / "maide_fastdds_profiles.xml";
  std::ofstream(profiles) << "<dds><library_settings><intraprocess_delivery>OFF"
                             "</intraprocess_delivery></library_settings></dds>";
  ASSERT_EQ(::setenv("FASTRTPS_DEFAULT_PROFILES_FILE", profiles.c_str(), 1), 0);
  ASSERT_EQ(::setenv("ROS_DISCOVERY_SERVER", "127.0.0.1:11811", 1), 0);
  EXPECT_EQ(play({}, {0, 1}), (std::vector<std::string>{"quiet", "message"}));
  std::filesystem::remove(profiles);
}

// The local addresses of this process's UDP sockets.
std::vector<std::string> udp_addresses() {
  std::set<std::string> own;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;  // the iterator's own descriptor
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    if (target.starts_with("socket:[")) own.insert(target.substr(8, target.size() - 9));
  }
  std::vector<std::string> addresses;
  for (const char* family : {"udp", "udp6"}) {
    std::ifstream table(std::string("/proc/self/net/") + family);
    for (std::string line; std::getline(table, line);) {
      std::istringstream fields(line);
      std::vector<std::string> words{std::istream_iterator<std::string>(fields), {}};
      if (words.size() > 9 && own.contains(words[9])) {
        addresses.push_back(words[1].substr(0, words[1].find(':')));
      }
    }
  }
  return addresses;
}

// Wrappers side by side, and the robots on the network, must not meet.
TEST(FastDdsWrapper, HasSocketsOnTheLoopbackAloneAndNoMulticast) {
  for (const char* transport : {"none", "udp"}) {
    fastdds::FastDdsWrapper wrapper;
    const LocalSul sul(wrapper, {{"transport", transport}});
    EXPECT_THAT(udp_addresses(), testing::Each("0100007F")) << transport;
  }
}

TEST(FastDdsWrapper, TriesItself) {
  fastdds::FastDdsWrapper wrapper;
  EXPECT_THAT(run_self_test(wrapper), testing::EndsWith(": write -> quiet, read -> message"));
}

}  // namespace
}  // namespace maide
