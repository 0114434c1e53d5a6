// The form of a line, and what each level lets through.
#include "maide/base/log.hpp"

#include <gtest/gtest.h>

#include <string>

namespace maide {
namespace {

std::string said_at(LogLevel level) {
  testing::internal::CaptureStderr();
  set_up_log("maide", level);
  log_warning("w {}");
  log_note("n");
  log_detail("d");
  return testing::internal::GetCapturedStderr();
}

TEST(Log, LevelsAndForm) {
  EXPECT_EQ(said_at(LogLevel::quiet), "maide: warning: w {}\n");
  EXPECT_EQ(said_at(LogLevel::normal), "maide: warning: w {}\nmaide: n\n");
  EXPECT_EQ(said_at(LogLevel::verbose), "maide: warning: w {}\nmaide: n\nmaide: d\n");
}

}  // namespace
}  // namespace maide
