// Fast DDS learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// every time the same, on a busy machine too.
#include <gtest/gtest.h>

#include <string>

#include "fastdds_cases.hpp"
#include "maide/automata/compare.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

class FastDdsMealy : public testing::TestWithParam<test::CycloneDdsCase> {};

TEST_P(FastDdsMealy, IsLearned) {
  const Mealy learned = test::learn_system("fastdds", GetParam().options).machine;
  EXPECT_EQ(learned.size(), GetParam().states);
  EXPECT_FALSE(find_difference(test::make_connection(GetParam().model), learned).has_value());
}

INSTANTIATE_TEST_SUITE_P(Policies, FastDdsMealy, testing::ValuesIn(test::fastdds_cases()),
                         [](const auto& tested) { return tested.param.name; });

class FastDdsRepeatedly : public testing::TestWithParam<std::size_t> {};

TEST_P(FastDdsRepeatedly, GivesTheSameModelTwentyTimes) {
  test::expect_same_twenty_times("fastdds",
                                 {{"depth", "2"},
                                  {"payload", "gap"},
                                  {"inputs", "write,tryread"},
                                  {"observe", "message,null"}},
                                 4, GetParam());
}

INSTANTIATE_TEST_SUITE_P(BusyProcesses, FastDdsRepeatedly, testing::Values(0, 2));

class FastDdsLateReader : public testing::TestWithParam<std::size_t> {};

TEST_P(FastDdsLateReader, GivesTheSameModelTwentyTimes) {
  test::expect_same_twenty_times("fastdds",
                                 {{"depth", "1"},
                                  {"reliability", "reliable"},
                                  {"durability", "transient_local"},
                                  {"inputs", "write,tryread,disconnect,connect"},
                                  {"observe", "message,null"}},
                                 5, GetParam());
}

INSTANTIATE_TEST_SUITE_P(BusyProcesses, FastDdsLateReader, testing::Values(0, 2));

}  // namespace
}  // namespace maide
