// The same model every time, on a busy machine too; and strict buffers up to 16 messages.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "wrapper_checks.hpp"

namespace maide {
namespace {

struct RepeatedCase {
  std::string name;
  test::SystemOptions options;
  std::size_t states;  // of the Mealy machine
};

void PrintTo(const RepeatedCase& tested, std::ostream* out) { *out << tested.name; }

class YarpRepeatedly : public testing::TestWithParam<RepeatedCase> {};

TEST_P(YarpRepeatedly, GivesTheSameModelTwentyTimes) {
  test::expect_same_twenty_times("yarp", GetParam().options, GetParam().states, 0);
}

TEST_P(YarpRepeatedly, GivesTheSameModelTwentyTimesBesideTwoBusyProcesses) {
  test::expect_same_twenty_times("yarp", GetParam().options, GetParam().states, 2);
}

INSTANTIATE_TEST_SUITE_P(
    Models, YarpRepeatedly,
    testing::Values(RepeatedCase{"port", {}, 3},
                    RepeatedCase{"buffered", {{"kind", "buffered"}}, 3},
                    RepeatedCase{"buffered_tryread",
                                 {{"kind", "buffered"}, {"inputs", "write,read,tryread"}},
                                 3},
                    RepeatedCase{"strict_3", {{"kind", "strict"}, {"size", "3"}}, 5},
                    RepeatedCase{"strict_6", {{"kind", "strict"}, {"size", "6"}}, 8},
                    RepeatedCase{"interrupt",
                                 {{"inputs", "write,read,interrupt"},
                                  {"observe", "message,written,failed,done"}},
                                 6}),
    [](const auto& tested) { return tested.param.name; });

TEST(YarpStrict, HasThePapersSizesUpToSixteen) {
  for (std::size_t size = 7; size <= 16; ++size) {
    const InterfaceAutomaton learned =
        test::learn_system("yarp", {{"kind", "strict"}, {"size", std::to_string(size)}}).automaton;
    EXPECT_EQ(learned.size(), 2 * size + 2);
    EXPECT_EQ(learned.transition_count(), 3 * size + 2);
  }
}

}  // namespace
}  // namespace maide
