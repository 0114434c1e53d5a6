// Cyclone DDS learned for real, over its wrapper's pipes: what comes out is the model written by
// hand, the paper's buffered port among them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cyclonedds_cases.hpp"
#include "maide/automata/compare.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/learners.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using test::SystemOptions;

InterfaceAutomaton reference(const std::string& name) {
  return read_interface_automaton(std::string(MAIDE_SOURCE_DIR "/tests/models/") + name + ".dot");
}

class CycloneDdsMealy : public testing::TestWithParam<test::CycloneDdsCase> {};

TEST_P(CycloneDdsMealy, IsLearned) {
  const Mealy model = test::make_connection(GetParam().model);
  for (const LearnerEntry& algorithm : learners()) {
    // Four inputs take long: the default learner alone.
    if (GetParam().model.reconnects && algorithm.name != learners().front().name) continue;
    const Mealy learned =
        test::learn_system("cyclonedds", GetParam().options, algorithm.name).machine;
    EXPECT_EQ(learned.size(), GetParam().states) << algorithm.name;
    EXPECT_FALSE(find_difference(model, learned).has_value()) << algorithm.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, CycloneDdsMealy, testing::ValuesIn(test::cyclonedds_cases()),
                         [](const auto& tested) { return tested.param.name; });

// The names of the reference ports whose models Cyclone's connections share.
struct PortCase {
  std::string name;
  SystemOptions options;
  std::string reference;
};

void PrintTo(const PortCase& tested, std::ostream* out) { *out << tested.name; }

class CycloneDdsAutomaton : public testing::TestWithParam<PortCase> {};

TEST_P(CycloneDdsAutomaton, IsThatOfThePort) {
  const InterfaceAutomaton expected = reference(GetParam().reference);
  for (const Translation translation : {Translation::eager, Translation::av}) {
    const InterfaceAutomaton learned =
        test::learn_system("cyclonedds", GetParam().options, "", translation).automaton;
    EXPECT_EQ(learned.size(), expected.size());
    EXPECT_TRUE(compare(expected, learned).same());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Ports, CycloneDdsAutomaton,
    testing::Values(PortCase{"defaults", {}, "buffered"},
                    PortCase{"tryread", {{"inputs", "write,read,tryread"}}, "buffered-tryread"},
                    PortCase{"keep_all_1", {{"history", "keep_all"}, {"size", "1"}}, "strict-1"},
                    PortCase{"keep_all_3", {{"history", "keep_all"}, {"size", "3"}}, "strict-3"},
                    PortCase{"keep_all_3_tryread_absorb",
                             {{"history", "keep_all"},
                              {"size", "3"},
                              {"at-bound", "absorb"},
                              {"inputs", "write,read,tryread"}},
                             "strict-3-tryread-absorb"},
                    PortCase{"keep_all_6", {{"history", "keep_all"}, {"size", "6"}}, "strict-6"}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
