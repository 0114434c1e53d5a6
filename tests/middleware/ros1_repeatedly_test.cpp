// The same connection of ROS 1 learned again and again gives the same model, byte for byte, on a
// busy machine too.
#include <gtest/gtest.h>

#include "wrapper_checks.hpp"

namespace maide {
namespace {

class Ros1Repeatedly : public testing::TestWithParam<std::size_t> {};

TEST_P(Ros1Repeatedly, GivesTheSameModelTwentyTimes) {
  test::expect_same_twenty_times("ros1",
                                 {{"queue_size", "2"},
                                  {"payload", "gap"},
                                  {"inputs", "write,tryread"},
                                  {"observe", "message,null"}},
                                 4, GetParam());
}

INSTANTIATE_TEST_SUITE_P(BusyProcesses, Ros1Repeatedly, testing::Values(0, 2));

}  // namespace
}  // namespace maide
