// `maide format`: in place, or looked at alone; a file that cannot be laid out stays as it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

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
