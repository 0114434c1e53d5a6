// `maide new wrapper` and `maide init`: what they write runs at once. The wrappers are learned
// through in tests/systems.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

TEST(NewWrapper, SaysWhatIsWrong) {
  expect_error(run_maide({"new"}), 2, "WHAT");
  expect_error(run_maide({"new", "robot", "--tcp", "a:1"}), 2, "robot");
  expect_error(run_maide({"new", "wrapper"}), 2, "--tcp HOST:PORT");
  for (const char* address : {"localhost", ":21", "localhost:", "localhost:0", "localhost:65536",
                              "localhost:x", "localhost:999999"}) {
    expect_error(run_maide({"new", "wrapper", "--tcp", address}), 2, "HOST:PORT");
  }
  const std::vector<std::string> good{"new", "wrapper", "--tcp", "localhost:21"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = good;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_maide(arguments);
  };
  expect_error(with({"--python", "--cpp"}), 2, "exclude each other");
  expect_error(with({"--input", "a=b", "--input", "a=c"}), 2, "'a'");
  expect_error(with({"--input", "=b"}), 2, "without a name");
  expect_error(with({"--input", "Delta"}), 2, "Delta");
  expect_error(with({"--input", "a=b\nc"}), 2, "control character");
  const TempDir folder;
  const std::string file = (folder.path() / "mine.py").string();
  write_file_atomically(file, "my work");
  expect_error(with({"-o", file}), 2, file);
  EXPECT_EQ(read_file(file), "my work");
}

TEST(NewWrapper, PutsServerAndLinesIntoTheExample) {
  for (const std::string language : {"--python", "--cpp"}) {
    const SubprocessResult result =
        run_maide({"new", "wrapper", "--tcp", "robot.local:2000", "--lines", language, "--input",
                   "say=SAY \"h\\i\"=", "--input", "QUIT", "--reset", "FLUSH 1"});
    ASSERT_EQ(result.exit_status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("\"robot.local:2000\""));
    EXPECT_THAT(result.out, HasSubstr(R"("SAY \"h\\i\"=")"));
    EXPECT_THAT(result.out, HasSubstr("\"FLUSH 1\""));
    EXPECT_THAT(result.out, testing::Not(HasSubstr("\"NOOP\"")));
  }
  const Json json = json_of(run_maide({"new", "wrapper", "--tcp", "h:1", "--json"}));
  EXPECT_EQ(json.at("inputs"), (Json{"HELP", "NOOP", "QUIT"}));
  EXPECT_EQ(json.at("language"), "python");
}

TEST(Init, WritesASystemThatIsCheckedAtOnce) {
  const TempDir folder;
  const std::string file = (folder.path() / "robot.yaml").string();
  const SubprocessResult made = run_maide({"init", file, "--system", "port", "--json"});
  ASSERT_EQ(made.exit_status, 0) << made.err;
  EXPECT_EQ(json_of(made).at("system"), "port");
  const SubprocessResult checked = run_maide({"check", file, "--json"});
  EXPECT_EQ(checked.exit_status, 1) << checked.err;
  const Json verdicts = json_of(checked);
  for (const Json& property : verdicts.at("properties")) {
    const bool is_stuck = property.at("name") == "stuck" || property.at("name") == "error";
    EXPECT_EQ(property.at("verdict"), is_stuck ? "holds" : "violated") << property.at("name");
  }
  EXPECT_EQ(run_maide({"format", "--check", file}).exit_status, 0);
  expect_error(run_maide({"init", file, "--system", "port"}), 2, file);
}

TEST(Init, TakesWhatIsUsableHere) {
  const TempDir folder;
  const std::string file = (folder.path() / "robot.yaml").string();
  const SubprocessResult made = run_maide({"init", file, "--json"});
  ASSERT_EQ(made.exit_status, 0) << made.err;  // the port is always usable
  EXPECT_THAT(read_file(file),
              HasSubstr("learn: " + json_of(made).at("system").get<std::string>() + ","));
  expect_error(run_maide({"init", file + ".txt"}), 2, ".yaml");
  expect_error(run_maide({"init", file + ".yaml", "--system", "corba"}), 2, "cyclonedds");
}

}  // namespace
}  // namespace maide::test
