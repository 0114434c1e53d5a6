// What a report of progress says, and that nothing is drawn where there is no terminal.
#include <gtest/gtest.h>

#include "maide/base/log.hpp"

namespace maide {
namespace {

Progress make_progress(std::uint64_t states, std::uint64_t words, std::uint64_t done,
                       std::uint64_t total) {
  Progress progress;
  progress.phase = "learning";
  progress.states = states;
  progress.words = words;
  progress.done = done;
  progress.total = total;
  return progress;
}

TEST(ProgressLine, LeavesOutWhatDoesNotApply) {
  EXPECT_EQ(to_string(make_progress(0, 0, 0, 0)), "learning");
  EXPECT_EQ(to_string(make_progress(1, 1, 0, 0)), "learning: 1 state, 1 word");
  EXPECT_EQ(to_string(make_progress(12, 0, 3, 0)), "learning: 12 states, 3 done");
  EXPECT_EQ(to_string(make_progress(2, 0, 0, 10)), "learning: 2 states, 0 of 10, 10 left");
}

TEST(ProgressLine, DrawsNothingWithoutATerminal) {
  testing::internal::CaptureStderr();  // a file
  ProgressLine line(true);
  line.on_progress(make_progress(1, 2, 3, 4));
  clear_progress_line();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace maide
