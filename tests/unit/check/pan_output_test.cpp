// What SPIN and pan print.
#include <gtest/gtest.h>

#include "maide/check/engines/spin_engine.hpp"

namespace maide {
namespace {

const std::string complete =
    "\n(Spin Version 6.5.2 -- 6 December 2019)\n\nFull statespace search for:\n"
    "State-vector 64 byte, depth reached 19, errors: 0\n"
    "       14 states, stored\n        0 states, matched\n"
    "       14 transitions (= stored+matched)\n        0 atomic steps\n"
    "  128.653\ttotal actual memory usage\n";

TEST(PanOutput, ReadsTheCounts) {
  const auto output = parse_pan_output(complete);
  ASSERT_TRUE(output);
  EXPECT_EQ(output->errors, 0u);
  EXPECT_EQ(output->states, 14u);
  EXPECT_EQ(output->transitions, 14u);
  EXPECT_EQ(output->peak_bytes >> 20, 128u);
  EXPECT_TRUE(output->is_complete);
}

TEST(PanOutput, LargeCountsAreInScientificNotation) {
  std::string text = complete;
  text.replace(text.find("14 states"), 2, "1.9867e+06");
  EXPECT_EQ(parse_pan_output(text)->states, 1986700u);
}

TEST(PanOutput, TruncatedSearchesAreNotComplete) {
  for (const char* limit : {"error: max search depth too small\n", "pan: reached -DMEMLIM bound\n",
                            "Warning: Search not completed\n", "pan: out of memory\n"}) {
    const auto output = parse_pan_output(limit + complete);
    ASSERT_TRUE(output);
    EXPECT_FALSE(output->is_complete) << limit;
  }
}

TEST(PanOutput, OtherTextIsNoOutput) {
  EXPECT_FALSE(parse_pan_output(""));
  EXPECT_FALSE(parse_pan_output("Segmentation fault"));
  EXPECT_FALSE(parse_pan_output(complete.substr(0, 60)));
}

}  // namespace
}  // namespace maide
