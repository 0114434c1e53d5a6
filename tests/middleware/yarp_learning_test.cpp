// YARP's ports learned for real, over the wrapper's pipes: the paper's models in their sizes, and
// its finding about interrupt.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "published_results.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using test::SystemOptions;

class YarpAutomaton : public testing::TestWithParam<test::PortCase> {};

TEST_P(YarpAutomaton, IsThatOfThePaper) { test::expect_port("yarp", GetParam()); }

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
    testing::Values(test::PortCase{"port", {}, "port"},
                    test::PortCase{"buffered", {{"kind", "buffered"}}, "buffered"},
                    test::PortCase{"buffered_tryread", with_tryread({{"kind", "buffered"}}),
                                   "buffered-tryread"},
                    test::PortCase{"strict_1", strict(1), "strict-1"},
                    test::PortCase{"strict_2", strict(2), "strict-2"},
                    test::PortCase{"strict_3", strict(3), "strict-3"},
                    test::PortCase{"strict_3_tryread", with_tryread(strict(3)),
                                   "strict-3-tryread-absorb"},
                    test::PortCase{"strict_4", strict(4), "strict-4"},
                    test::PortCase{"strict_5", strict(5), "strict-5"},
                    test::PortCase{"strict_6", strict(6), "strict-6"}),
    [](const auto& tested) { return tested.param.name; });

TEST(YarpAutomaton, IsTheSameThroughTheTransducer) {
  const InterfaceAutomaton eager = test::learn_system("yarp", strict(2)).automaton;
  const InterfaceAutomaton av =
      test::learn_system("yarp", strict(2), "", Translation::av).automaton;
  EXPECT_TRUE(compare(eager, av).same());
}

TEST(YarpServer, ChangesNothing) {
#ifndef MAIDE_YARPSERVER
  GTEST_SKIP() << "skipped: there was no yarpserver when this was configured";
#endif
  test::SystemOptions options = strict(2);
  options["server"] = "own";
  const InterfaceAutomaton learned = test::learn_system("yarp", options).automaton;
  EXPECT_TRUE(compare(test::learn_system("yarp", strict(2)).automaton, learned).same());
}

TEST(YarpServer, ThatIsNotThereIsSaid) {
  EXPECT_THROW(test::learn_system("yarp", {{"server", "here"}}), UsageError);
  EXPECT_THROW(test::learn_system("yarp", {{"server", "127.0.0.1:4"}, {"inputs", "write,close"}}),
               UsageError);
}

TEST(YarpInterrupt, IsTheOneOfThePaper) {
  const Mealy learned = test::learn_system("yarp", interrupt_options()).machine;
  EXPECT_FALSE(find_difference(learned, paper_interrupt_model()).has_value());
  const auto unexpected = find_difference(learned, expected_interrupt_model());
  ASSERT_TRUE(unexpected.has_value());
  EXPECT_EQ(unexpected->word, (std::vector<std::string>{"write", "interrupt"}));
}

// The port of a writer that was interrupted and written to cannot be deleted: that ends the
// process.
TEST(YarpInterrupt, AndAWriteMakeTheDestructorCrash) {
  const Mealy learned = test::learn_system("yarp", {{"kind", "strict"},
                                                    {"size", "1"},
                                                    {"inputs", "interrupt,write,destroy"},
                                                    {"observe", "message,destroyed"}})
                            .machine;
  const auto last_output = [&](const Word& word) {
    return learned.outputs().name(learned.output_word(word).back());
  };
  EXPECT_EQ(last_output({0, 2}), "destroyed");
  EXPECT_EQ(last_output({1, 2}), "destroyed");
  EXPECT_EQ(last_output({0, 1, 2}), "crash");
}

}  // namespace
}  // namespace maide
