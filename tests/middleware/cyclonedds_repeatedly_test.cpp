// Cyclone DDS gives the same model every time, within a process and over the network, on a busy
// machine too.
#include <gtest/gtest.h>

#include <cstddef>
#include <tuple>

#include "cyclonedds_cases.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using Repeated = std::tuple<test::CycloneDdsCase, std::size_t>;

class CycloneDdsRepeatedly : public testing::TestWithParam<Repeated> {};

TEST_P(CycloneDdsRepeatedly, GivesTheSameModelTwentyTimes) {
  const auto& [tested, busy_processes] = GetParam();
  test::expect_same_twenty_times("cyclonedds", tested.options, tested.states, busy_processes);
}

std::string name_of(const testing::TestParamInfo<Repeated>& info) {
  const auto& [tested, busy_processes] = info.param;
  return tested.name + "_busy_" + std::to_string(busy_processes);
}

std::vector<test::CycloneDdsCase> cases() {
  std::vector<test::CycloneDdsCase> chosen;
  for (const auto& all : {test::cyclonedds_cases(), test::cyclonedds_udp_cases()}) {
    for (const test::CycloneDdsCase& each : all) {
      if (each.name == "keep_last_2" || each.name == "keep_last_2_udp" ||
          each.name == "volatile_gap") {
        chosen.push_back(each);
      }
    }
  }
  return chosen;
}

INSTANTIATE_TEST_SUITE_P(Policies, CycloneDdsRepeatedly,
                         testing::Combine(testing::ValuesIn(cases()), testing::Values(0, 2)),
                         name_of);

}  // namespace
}  // namespace maide
