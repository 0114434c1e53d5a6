// `maide export` with the real program; what the formats look like is approved in tests/golden.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/base/file.hpp"
#include "maide/base/temp_dir.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string model(const std::string& name) {
  return MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot";
}
std::string approved(const std::string& file) {
  return read_file(MAIDE_SOURCE_DIR "/tests/golden/approved/" + file + ".approved");
}

TEST(Export, WritesToStandardOutput) {
  const SubprocessResult result = run_maide({"export", model("strict-2"), "--to", "promela"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.out, approved("strict-2.pml"));
}

TEST(Export, WritesToAFile) {
  const TempDir folder;
  const std::string file = (folder.path() / "strict-2.smv").string();
  const SubprocessResult result =
      run_maide({"export", model("strict-2"), "--to", "smv", "-o", file, "--json"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(read_file(file), approved("strict-2.smv"));
  const Json json = json_of(result);
  EXPECT_EQ(json.at("output"), file);
  EXPECT_EQ(json.at("states"), 6);
  EXPECT_EQ(json.at("transitions"), 8);
}

TEST(Export, JsonWithoutAFileHoldsTheText) {
  const Json json =
      json_of(run_maide({"export", model("buffered-tryread"), "--to", "aut", "--json"}));
  EXPECT_EQ(json.at("text"), approved("buffered-tryread.aut"));
}

TEST(Export, TheClassIsNamedAfterTheFile) {
  EXPECT_THAT(run_maide({"export", model("strict-2"), "--to", "cpp"}).out,
              HasSubstr("class strict_2 {"));
}

TEST(Export, MarksAreLostOnlyWhenAsked) {
  expect_error(run_maide({"export", model("strict-2"), "--to", "aut"}), 2, "--lossy");
  const SubprocessResult result =
      run_maide({"export", model("strict-2"), "--to", "aut", "--lossy"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.out, StartsWith("des (0, 8, 6)"));
}

// A system is written as Promela that spin accepts; other languages have no word for it.
TEST(Export, SystemsAsPromela) {
  const TempDir folder;
  const std::string system = (folder.path() / "system.yaml").string();
  write_file_atomically(system, "models:\n  via: {file: " + model("port") +
                                    "}\nprograms:\n  planner: |\n    loop { via.write; }\n  "
                                    "tracker: |\n    loop { via.read -> message; }\n");
  const std::string file = (folder.path() / "system.pml").string();
  const SubprocessResult result =
      run_maide({"export", system, "--to", "promela", "-o", file, "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(json_of(result).at("programs"), 2);
  SubprocessOptions options;
  options.folder = folder.path();
  const SubprocessResult generated = run_program({"spin", "-a", file}, options);
  EXPECT_TRUE(generated.succeeded()) << generated.out << generated.err;
  expect_error(run_maide({"export", system, "--to", "smv"}), 2, "promela alone");
}

TEST(Export, UnknownFormatsAreErrors) {
  expect_error(run_maide({"export", model("port"), "--to", "png"}), 2,
               "unknown format 'png'; known are: dot, aut, promela, smv, cpp");
  expect_error(run_maide({"export", model("port"), "--to", "mcrl2"}), 2, "mcrl2");
  expect_error(run_maide({"export", model("port")}), 2, "--to");
  expect_error(run_maide({"export", model("port"), "--to", "dot", "-o", "/no/such/folder/x.dot"}),
               2, "(/no/such/folder/x.dot)");
}

}  // namespace
}  // namespace maide::test
