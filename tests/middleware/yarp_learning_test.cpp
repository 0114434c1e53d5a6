// YARP's ports learned for real, over the wrapper's pipes: the paper's models in their sizes, and
// its finding about interrupt.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "maide/automata/compare.hpp"
#include "maide/formats/model_file.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using test::SystemOptions;

struct YarpCase {
  std::string name;
  SystemOptions options;
  std::string reference;  // in tests/models
};

void PrintTo(const YarpCase& tested, std::ostream* out) { *out << tested.name; }

class YarpAutomaton : public testing::TestWithParam<YarpCase> {};

TEST_P(YarpAutomaton, IsThatOfThePaper) {
  const InterfaceAutomaton expected = read_interface_automaton(
      std::string(MAIDE_SOURCE_DIR "/tests/models/") + GetParam().reference + ".dot");
  const InterfaceAutomaton learned = test::learn_system("yarp", GetParam().options).automaton;
  EXPECT_EQ(learned.size(), expected.size());
  EXPECT_EQ(learned.transition_count(), expected.transition_count());
  EXPECT_TRUE(compare(expected, learned).same());
}

SystemOptions strict(std::size_t size) {
  return {{"kind", "strict"}, {"size", std::to_string(size)}};
}

SystemOptions with_tryread(SystemOptions options) {
  options["inputs"] = "write,read,tryread";
  options["at-bound"] = "absorb";
  return options;
}

INSTANTIATE_TEST_SUITE_P(
    Table1, YarpAutomaton,
    testing::Values(
        YarpCase{"port", {}, "port"}, YarpCase{"buffered", {{"kind", "buffered"}}, "buffered"},
        YarpCase{"buffered_tryread", with_tryread({{"kind", "buffered"}}), "buffered-tryread"},
        YarpCase{"strict_1", strict(1), "strict-1"}, YarpCase{"strict_2", strict(2), "strict-2"},
        YarpCase{"strict_3", strict(3), "strict-3"},
        YarpCase{"strict_3_tryread", with_tryread(strict(3)), "strict-3-tryread-absorb"},
        YarpCase{"strict_4", strict(4), "strict-4"}, YarpCase{"strict_5", strict(5), "strict-5"},
        YarpCase{"strict_6", strict(6), "strict-6"}),
    [](const auto& tested) { return tested.param.name; });

TEST(YarpAutomaton, IsTheSameThroughTheTransducer) {
  const InterfaceAutomaton eager = test::learn_system("yarp", strict(2)).automaton;
  const InterfaceAutomaton av =
      test::learn_system("yarp", strict(2), "", Translation::av).automaton;
  EXPECT_TRUE(compare(eager, av).same());
}

}  // namespace
}  // namespace maide
