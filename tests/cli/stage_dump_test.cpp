// Dumps of stages on the command line, moved away from their files, and where a system is read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

class StageDumps : public testing::Test {
 protected:
  StageDumps() {
    std::filesystem::create_directory(folder_.path() / "a");
    std::filesystem::create_directory(folder_.path() / "b");
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string dump(const std::string& stage) const {
    const std::string file = path("b/" + stage + ".json");
    const SubprocessResult result =
        run_maide({"view", "--stage", stage, path("a/s.yaml"), "-o", file});
    EXPECT_EQ(result.exit_status, 0) << result.err;
    return file;
  }
  TempDir folder_;
};

TEST_F(StageDumps, NamesOfFilesAreThoseBesideTheSystem) {
  const std::string machine =
      "digraph g { inputs=\"write\"; outputs=\"full\"; __start0 -> s0; "
      "s0 -> s1 [label=\"?write\"]; ";
  write_file_atomically(path("a/m.dot"), machine + "s1 -> s1 [label=\"?write\"]; }");
  write_file_atomically(path("b/m.dot"), machine + "s1 -> s0 [label=\"!full\"]; }");
  write_file_atomically(path("a/s.yaml"),
                        "models: {m: {learn: \"sim:m.dot\", when_weak: accept}}\n"
                        "programs: {a: \"m.write; m.write; @d skip;\"}\n");
  const SubprocessResult plain = run_maide({"check", path("a/s.yaml")});
  EXPECT_EQ(plain.exit_status, 0) << plain.out << plain.err;
  for (const char* stage : {"names", "models", "system"}) {
    EXPECT_EQ(run_maide({"check", dump(stage)}).exit_status, 0) << stage;
  }
}

TEST_F(StageDumps, AreReplayedAndExported) {
  write_file_atomically(path("a/s.yaml"),
                        "models: {port: {learn: port, with: {kind: strict, size: 2}}}\n"
                        "programs: {a: \"repeat 2 { port.write; }\", "
                        "b: \"repeat 3 { port.read -> message; }\"}\n");
  const std::string trace = path("t.json");
  EXPECT_EQ(run_maide({"check", path("a/s.yaml"), "--trace", trace}).exit_status, 1);
  const std::string promela = run_maide({"export", path("a/s.yaml"), "--to", "promela"}).out;
  for (const char* stage : {"names", "models", "system"}) {
    const std::string file = dump(stage);
    EXPECT_EQ(run_maide({"export", file, "--to", "promela"}).out, promela) << stage;
    const SubprocessResult replayed = run_maide({"replay", file, trace});
    if (std::string(stage) == "system") {
      EXPECT_EQ(replayed.exit_status, 2);
      EXPECT_THAT(replayed.err, HasSubstr("which system model port stands for is not known"));
    } else {
      EXPECT_EQ(replayed.exit_status, 0) << stage << replayed.out << replayed.err;
    }
  }
}

}  // namespace
}  // namespace maide::test
