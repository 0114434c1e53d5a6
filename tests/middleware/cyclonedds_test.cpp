// Cyclone DDS for real, in this process: the answers to all words up to a length are those of the
// models written by hand, and those models have the sizes that theory gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cyclonedds_cases.hpp"
#include "cyclonedds_wrapper.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

class CycloneDds : public testing::TestWithParam<test::CycloneDdsCase> {};

TEST_P(CycloneDds, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_connection(GetParam().model);
  EXPECT_EQ(model.size(), GetParam().states);
  cyclonedds::CycloneDdsWrapper wrapper;
  std::size_t length = GetParam().model.reconnects ? 6 : 9;
  if (GetParam().options.contains("transport")) length -= 2;  // resets of 10 ms
  test::expect_answers(wrapper, GetParam().options, model, length);
}

INSTANTIATE_TEST_SUITE_P(Policies, CycloneDds, testing::ValuesIn(test::cyclonedds_cases()),
                         [](const auto& tested) { return tested.param.name; });

INSTANTIATE_TEST_SUITE_P(Network, CycloneDds, testing::ValuesIn(test::cyclonedds_udp_cases()),
                         [](const auto& tested) { return tested.param.name; });

// A depth is each end's own, and ends that do not match never meet.
TEST(CycloneDdsEnds, HaveQosOfTheirOwn) {
  test::expect_qos_of_each_end<cyclonedds::CycloneDdsWrapper>();
}

std::string error_of(const test::SystemOptions& options) {
  cyclonedds::CycloneDdsWrapper wrapper;
  return test::usage_error_of(wrapper, options);
}

TEST(CycloneDdsOptions, ThatMakeNoSenseAreRefused) {
  EXPECT_EQ(error_of({{"history", "keep_all"}, {"depth", "3"}, {"size", "3"}}),
            "option depth: it means nothing with history=keep_all");
  EXPECT_EQ(error_of({{"max-samples", "3"}}), "option max-samples: it needs history=keep_all");
  EXPECT_THAT(error_of({{"history", "keep_all"}}), testing::HasSubstr("say size=N"));
  EXPECT_EQ(error_of({{"history", "keep_all"}, {"max_samples", "2"}, {"size", "0"}}), "");
  EXPECT_THAT(error_of({{"history", "keep_all"},
                        {"max_samples", "2"},
                        {"reliability", "reliable"},
                        {"transport", "udp"}}),
              testing::HasSubstr("buffers of the protocol"));
}

TEST(CycloneDdsWrapper, SaysWhatItIs) {
  cyclonedds::CycloneDdsWrapper wrapper;
  const LocalSul sul(wrapper, {{"history", "keep_all"},
                               {"max-samples", "2"},
                               {"reliability", "reliable"},
                               {"payload", "gap"}});
  const SulInfo& info = sul.info();
  EXPECT_EQ(info.name, "cyclonedds");
  EXPECT_FALSE(info.versions.at("cyclonedds").empty());
  EXPECT_EQ(info.actors, (std::vector<std::string>{"writer", "reader"}));
  EXPECT_EQ(info.inputs.at(0).returns, std::vector<std::string>{"written"});
  EXPECT_EQ(info.inputs.at(1).returns, (std::vector<std::string>{"next", "gap"}));
  EXPECT_EQ(info.bound, "");
}

// Wrappers side by side, and the robots on the network, must not meet; nor may a user's
// configuration change what is learned.
TEST(CycloneDdsWrapper, HasNoNetworkWhateverTheEnvironmentSays) {
  ASSERT_EQ(::setenv("CYCLONEDDS_URI", "<General><Transport>udp</Transport></General>", 1), 0);
  cyclonedds::CycloneDdsWrapper wrapper;
  LocalSul sul(wrapper);
  std::vector<std::string> answer;
  const SulQuery query{Word{0, 1}, Translation::eager};
  sul.run(std::span(&query, 1),
          [&](std::size_t, const SulAnswer& given) { answer = test::outputs(given); }, {});
  EXPECT_EQ(answer, (std::vector<std::string>{"quiet", "message"}));
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;  // the iterator's own descriptor
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    EXPECT_FALSE(target.starts_with("socket:")) << target;
  }
  ::unsetenv("CYCLONEDDS_URI");
}

TEST(CycloneDdsWrapper, TriesItself) {
  cyclonedds::CycloneDdsWrapper wrapper;
  EXPECT_THAT(run_self_test(wrapper), testing::EndsWith(": write -> quiet, read -> message"));
}

}  // namespace
}  // namespace maide
