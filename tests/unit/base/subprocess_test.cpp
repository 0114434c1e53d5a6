// Real programs: what they print, how they end, and how they are ended.
#include "maide/base/subprocess.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <stop_token>
#include <string>
#include <thread>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"

namespace maide {
namespace {

SubprocessResult run_shell(const std::string& script, const SubprocessOptions& options = {}) {
  return run_program({"/bin/sh", "-c", script}, options);
}

TEST(Subprocess, KeepsBothOutputsAndTheExitStatus) {
  const SubprocessResult result = run_shell("echo out; echo err >&2; exit 7");
  EXPECT_EQ(result.out, "out\n");
  EXPECT_EQ(result.err, "err\n");
  EXPECT_EQ(result.exit_status, 7);
  EXPECT_FALSE(result.succeeded());
}

TEST(Subprocess, PassesWordsAsTheyAre) {
  EXPECT_EQ(run_program({"printf", "%s|", "a b", "$HOME", "", "'"}).out, "a b|$HOME||'|");
}

TEST(Subprocess, GivesMoreInputThanAPipeHolds) {
  SubprocessOptions options;
  options.input.assign(1 << 20, 'x');
  EXPECT_EQ(run_program({"cat"}, options).out, options.input);
}

TEST(Subprocess, AProgramMayIgnoreItsInput) {
  SubprocessOptions options;
  options.input.assign(1 << 20, 'x');
  EXPECT_TRUE(run_program({"true"}, options).succeeded());
}

TEST(Subprocess, RunsInAFolder) {
  const TempDir folder;
  SubprocessOptions options;
  options.folder = folder.path();
  EXPECT_EQ(run_program({"pwd", "-P"}, options).out,
            std::filesystem::canonical(folder.path()).string() + "\n");
}

TEST(Subprocess, CutsTooMuchOutput) {
  SubprocessOptions options;
  options.output_limit = 10;
  EXPECT_EQ(run_shell("yes | head -c 1000000", options).out.size(), 10U);
}

TEST(Subprocess, ASignalIsAnExitStatusAsInAShell) {
  EXPECT_EQ(run_shell("kill -9 $$").exit_status, 128 + SIGKILL);
}

TEST(Subprocess, EndsWhatTakesTooLong) {
  SubprocessOptions options;
  options.time_limit = std::chrono::milliseconds(20);
  const SubprocessResult result = run_shell("echo begun; sleep 1000", options);
  EXPECT_TRUE(result.timed_out);
  EXPECT_FALSE(result.succeeded());
}

TEST(Subprocess, DoesNotWaitForWhatTheProgramLeftBehind) {
  EXPECT_EQ(run_shell("echo begun; sleep 1000 &").out, "begun\n");
}

TEST(Subprocess, StopsWhenAsked) {
  std::stop_source source;
  RunControl control;
  control.stop = source.get_token();
  const std::jthread stopper([&] { source.request_stop(); });
  EXPECT_THROW(run_program({"sleep", "1000"}, {}, control), Interrupted);
}

TEST(Subprocess, SaysWhenItCannotStart) {
  EXPECT_THROW(run_program({"no-such-program-anywhere"}), UsageError);
  EXPECT_THROW(run_program({}), UsageError);
}

}  // namespace
}  // namespace maide
