// The path of the program comes from the build.
#include "run_maide.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace maide::test {

namespace {

SubprocessOptions limits() {
  SubprocessOptions options;
  options.time_limit = std::chrono::minutes(10);
  return options;
}

}  // namespace

SubprocessResult run_maide(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{MAIDE_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_program(command, limits());
}

SubprocessResult run_with_maide(const std::string& script) {
  return run_program({"/bin/sh", "-c", "maide=$1; " + script, "sh", MAIDE_PROGRAM}, limits());
}

SubprocessResult run_on_terminal(const std::vector<std::string>& arguments,
                                 const std::string& typed) {
  std::vector<std::string> command{MAIDE_PYTHON3, MAIDE_SOURCE_DIR "/tests/cli/on_terminal.py",
                                   typed, MAIDE_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_program(command, limits());
}

Json json_of(const SubprocessResult& result) {
  EXPECT_TRUE(result.out.ends_with('\n')) << result.out;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 1) << result.out;
  Json object = parse_json(result.out, "standard output");
  EXPECT_TRUE(object.is_object()) << result.out;
  return object;
}

void expect_error(const SubprocessResult& result, int exit_status, const std::string& text) {
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.exit_status, exit_status) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, testing::StartsWith("maide: "));
  EXPECT_THAT(result.err, testing::EndsWith("\n"));
  // One line, or that and the line of the source with a caret below it.
  const auto lines = std::count(result.err.begin(), result.err.end(), '\n');
  if (lines != 1) {
    EXPECT_EQ(lines, 3) << result.err;
    EXPECT_THAT(result.err, testing::ContainsRegex("\n  [ \t]*\\^\n$"));
  }
  EXPECT_THAT(result.err.substr(0, result.err.find('\n')), testing::HasSubstr(text));
}

bool can_step_through() { return !std::string(MAIDE_NODE).empty(); }

std::string step_through(const std::string& page, const std::string& keys) {
  const SubprocessResult played = run_program(
      {MAIDE_PYTHON3, MAIDE_SOURCE_DIR "/tests/cli/step_through.py", MAIDE_NODE, page, keys});
  EXPECT_EQ(played.exit_status, 0) << played.out << played.err;
  return played.out;
}

}  // namespace maide::test
