// `maide format`: in place, or looked at alone; a file that cannot be laid out stays as it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string untidy =
    "models: {q: {use: mutex}}   # one\nprograms:\n  p: \"loop{q.lock;q.unlock;}\"\n";
const std::string tidy =
    "models: {q: {use: mutex}}  # one\nprograms:\n  p: \"loop { q.lock; q.unlock; }\"\n";

TEST(FormatCommand, LaysAFileOutInPlace) {
  const TempDir folder("format-test");
  const std::string file = (folder.path() / "system.yaml").string();
  write_file_atomically(file, untidy);
  const SubprocessResult check = run_maide({"format", "--check", file});
  EXPECT_EQ(check.exit_status, 1) << check.err;
  EXPECT_EQ(check.out, file + " would be laid out anew\n");
  EXPECT_EQ(read_file(file), untidy);
  const SubprocessResult first = run_maide({"format", file, "--json"});
  EXPECT_EQ(first.exit_status, 0) << first.err;
  EXPECT_EQ(json_of(first)["files"][0]["changed"], true);
  EXPECT_EQ(read_file(file), tidy);
  const SubprocessResult second = run_maide({"format", file});
  EXPECT_EQ(second.exit_status, 0) << second.err;
  EXPECT_EQ(second.out, "");
  EXPECT_EQ(run_maide({"format", "--check", file}).exit_status, 0);
}

TEST(FormatCommand, BadInputIsOneLineAndLeavesTheFile) {
  const TempDir folder("format-test");
  const std::string file = (folder.path() / "system.yaml").string();
  const std::string broken = "programs:\n  p: |\n      loop {   q.lock;\n";
  write_file_atomically(file, broken);
  const SubprocessResult result = run_maide({"format", file});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("this '{' is not closed (" + file + ":3:12)"));
  EXPECT_EQ(read_file(file), broken);
  expect_error(run_maide({"format", (folder.path() / "none.yaml").string()}), 2, "cannot read");
  expect_error(run_maide({"format", folder.path().string()}), 2, "cannot read");
}

TEST(FormatCommand, AWrongFileStopsNoOther) {
  const TempDir folder("format-test");
  const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
  const std::string broken = "programs:\n  p: \"loop {\"\n";
  write_file_atomically(path("broken.yaml"), broken);
  const auto format = [&](std::vector<std::string> more) {
    write_file_atomically(path("a.yaml"), untidy);
    write_file_atomically(path("b.yaml"), untidy);
    std::vector<std::string> words{"format", path("a.yaml"), path("none.yaml"), path("broken.yaml"),
                                   path("b.yaml")};
    words.insert(words.end(), more.begin(), more.end());
    return run_maide(words);
  };
  const SubprocessResult said = format({});
  EXPECT_EQ(said.exit_status, 2);
  EXPECT_EQ(said.out, path("a.yaml") + " laid out\n" + path("b.yaml") + " laid out\n");
  EXPECT_THAT(said.err, HasSubstr("cannot read the file"));
  EXPECT_THAT(said.err, HasSubstr("this '{' is not closed (" + path("broken.yaml") +
                                  ":2:12)\n"
                                  "    p: \"loop {\"\n"));
  for (const char* name : {"a.yaml", "b.yaml"}) EXPECT_EQ(read_file(path(name)), tidy) << name;
  EXPECT_EQ(read_file(path("broken.yaml")), broken);
  const SubprocessResult result = format({"--json"});
  EXPECT_EQ(result.exit_status, 2);
  const Json json = json_of(result);
  ASSERT_EQ(json["files"].size(), 4u);
  EXPECT_EQ(json["files"][0], (Json{{"file", path("a.yaml")}, {"changed", true}}));
  EXPECT_THAT(json["files"][1]["error"].get<std::string>(), HasSubstr("cannot read"));
  EXPECT_EQ(json["files"][2]["changed"], false);
  EXPECT_EQ(json["files"][3]["changed"], true);
  EXPECT_EQ(json["status"], 2);
  EXPECT_EQ(json["error"], json["files"][2]["error"]);
}

TEST(FormatCommand, AFileThatCannotBeWrittenIsLeftWhole) {
  const TempDir folder("format-test");
  const std::string file = (folder.path() / "system.yaml").string();
  write_file_atomically(file, untidy);
  // No file may grow beyond nothing: as on a full disk.
  const SubprocessResult result =
      run_with_maide("trap '' XFSZ; ulimit -f 0; \"$maide\" format '" + file + "' 2>&1 | cat");
  EXPECT_THAT(result.out, HasSubstr("cannot write"));
  EXPECT_EQ(read_file(file), untidy);
}

}  // namespace
}  // namespace maide::test
