// System files whose models are learned when they are needed, and the pages that `maide check`
// writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "maide/base/temp_dir.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// Case study 1 with a burst of two over a connection that is learned.
std::string write_system(const TempDir& folder, const std::string& kind) {
  const std::string file = (folder.path() / "system.yaml").string();
  write_file_atomically(file, "models:\n  via: {learn: port, with: {kind: " + kind +
                                  "}}\n  sync: {learn: port, with: {kind: buffered}}\n"
                                  "programs:\n"
                                  "  planner: |\n"
                                  "    loop { repeat 2 { via.write; } sync.read -> message; }\n"
                                  "  controller: |\n"
                                  "    loop { repeat 2 { via.read -> message; } sync.write; }\n");
  return file;
}

std::size_t kept_models(const TempDir& folder) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder.path() / "maide-models")) {
    count += entry.path().extension() == ".dot" ? 1 : 0;
  }
  return count;
}

TEST(LearnedModels, AreLearnedOnceAndKeptBesideTheSystem) {
  const TempDir folder("check-test");
  const std::string file = write_system(folder, "buffered");
  const SubprocessResult first = run_maide({"check", file, "--property", "deadlock"});
  EXPECT_EQ(first.exit_status, 1) << first.err;
  EXPECT_THAT(first.err, HasSubstr("via: learning port kind=buffered"));
  EXPECT_THAT(first.err, HasSubstr("sync: learned before"));  // the same model
  EXPECT_EQ(kept_models(folder), 1U);
  const SubprocessResult second = run_maide({"check", file, "--property", "deadlock"});
  EXPECT_EQ(second.exit_status, 1);
  EXPECT_THAT(second.err, Not(HasSubstr("learning")));

  const std::string strict = write_system(folder, "strict");
  EXPECT_EQ(run_maide({"check", strict, "--property", "deadlock", "-q"}).exit_status, 0);
  EXPECT_EQ(kept_models(folder), 2U);
}

TEST(LearnedModels, AreLearnedForWhatIsSuggested) {
  const TempDir folder("check-test");
  const std::string file = write_system(folder, "buffered");
  const SubprocessResult result = run_maide(
      {"check", file, "--engine", "native", "--property", "deadlock", "--suggest", "--json"});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  const Json suggestions = json_of(result)["suggestions"];
  ASSERT_GE(suggestions.size(), 2U) << suggestions << result.err;
  EXPECT_THAT(suggestions[0].get<std::string>(),
              HasSubstr("via: port with kind=strict in place of buffered"));
  EXPECT_THAT(suggestions[0].get<std::string>(), HasSubstr("(learned and checked: "));
  EXPECT_THAT(suggestions.back().get<std::string>(),
              HasSubstr("`repeat 1` in place of `repeat 2` in lines 6 and 8"));
}

TEST(LearnedModels, AreLearnedAgainWhenTheSystemIsAnother) {
  const TempDir folder("check-test");
  const std::string file = (folder.path() / "system.yaml").string();
  const auto write_model = [&](const std::string& label) {
    write_file_atomically(folder.path() / "model.dot",
                          "digraph g { __start0 -> a; a -> b [label=\"?read\"]; "
                          "b -> a [label=\"!" +
                              label + "\"]; }");
  };
  write_file_atomically(file,
                        "models:\n  via: {learn: \"sim:model.dot\"}\n"
                        "programs:\n  reader: |\n    via.read -> message;\n");
  write_model("message");
  EXPECT_EQ(run_maide({"check", file, "--property", "deadlock", "-q"}).exit_status, 0);
  write_model("other");
  const SubprocessResult changed = run_maide({"check", file, "--property", "deadlock", "-q"});
  EXPECT_EQ(changed.exit_status, 2);
  EXPECT_THAT(changed.err, HasSubstr("message"));
}

TEST(LearnedModels, FailWithThePlaceThatAsksForThem) {
  const TempDir folder("check-test");
  const std::string file = write_system(folder, "round");
  const SubprocessResult result = run_maide({"check", file, "-q"});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("round"));
  EXPECT_THAT(result.err, HasSubstr("system.yaml:2:"));
}

TEST(Report, IsAPageOrAChart) {
  const TempDir folder("check-test");
  const std::string file = write_system(folder, "buffered");
  const std::string page = (folder.path() / "report.html").string();
  const std::string chart = (folder.path() / "chart.svg").string();
  run_maide({"check", file, "--property", "deadlock", "--report", page});
  run_maide({"check", file, "--property", "deadlock", "--report", chart});
  EXPECT_THAT(read_file(page), HasSubstr("deadlock: how it is violated"));
  EXPECT_THAT(read_file(page), HasSubstr("model via"));
  EXPECT_TRUE(read_file(chart).starts_with("<svg "));
  const SubprocessResult unwritable =
      run_maide({"check", file, "-q", "--property", "deadlock", "--report", "/no/such/x.html"});
  EXPECT_EQ(unwritable.exit_status, 2);
  EXPECT_THAT(unwritable.err, HasSubstr("/no/such"));
}

}  // namespace
}  // namespace maide::test
