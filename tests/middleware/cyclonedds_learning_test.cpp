// Cyclone DDS learned for real, over its wrapper's pipes: what comes out is the model written by
// hand, the paper's buffered port among them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cyclonedds_cases.hpp"
#include "maide/automata/compare.hpp"
#include "maide/learn/learner.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using test::SystemOptions;

class CycloneDdsMealy : public testing::TestWithParam<test::CycloneDdsCase> {};

TEST_P(CycloneDdsMealy, IsLearned) {
  const Mealy model = test::make_connection(GetParam().model);
  // All learners learn each policy at its least size. The default one learns the rest.
  const bool is_for_all = GetParam().name.ends_with("_1");
  for (const LearnerEntry& algorithm : deterministic_learners()) {
    if (!is_for_all && algorithm.name != learners().front().name) continue;
    const Mealy learned =
        test::learn_system("cyclonedds", GetParam().options, algorithm.name).machine;
    EXPECT_EQ(learned.size(), GetParam().states) << algorithm.name;
    EXPECT_FALSE(find_difference(model, learned).has_value()) << algorithm.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, CycloneDdsMealy, testing::ValuesIn(test::cyclonedds_cases()),
                         [](const auto& tested) { return tested.param.name; });

class CycloneDdsAutomaton : public testing::TestWithParam<test::PortCase> {};

TEST_P(CycloneDdsAutomaton, IsThatOfThePort) {
  test::expect_port("cyclonedds", GetParam());
  test::expect_port("cyclonedds", GetParam(), Translation::av);
}

INSTANTIATE_TEST_SUITE_P(
    Ports, CycloneDdsAutomaton,
    testing::Values(
        test::PortCase{"defaults", {}, "buffered"},
        test::PortCase{"tryread", {{"inputs", "write,read,tryread"}}, "buffered-tryread"},
        test::PortCase{"keep_all_1", {{"history", "keep_all"}, {"size", "1"}}, "strict-1"},
        test::PortCase{"keep_all_3", {{"history", "keep_all"}, {"size", "3"}}, "strict-3"},
        test::PortCase{"keep_all_3_tryread_absorb",
                       {{"history", "keep_all"},
                        {"size", "3"},
                        {"at-bound", "absorb"},
                        {"inputs", "write,read,tryread"}},
                       "strict-3-tryread-absorb"},
        test::PortCase{"keep_all_6", {{"history", "keep_all"}, {"size", "6"}}, "strict-6"}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
