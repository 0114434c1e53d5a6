// System files whose models are learned when they are needed, and the pages that `maide check`
// writes.
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

TEST(LearnedModels, AreNotBelievedSilentlyWhenTheyWereEdited) {
  const TempDir folder("check-test");
  const std::string file = write_system(folder, "strict");
  ASSERT_EQ(run_maide({"check", file, "--property", "deadlock"}).exit_status, 0);
  for (const auto& entry : fs::directory_iterator(folder.path() / "maide-models")) {
    if (entry.path().extension() != ".dot") continue;
    std::string text = read_file(entry.path());
    const std::string key = "checksum=\"";
    EXPECT_NE(text.find(key), std::string::npos) << text;
    text += "// a remark of mine\n\n";
    if (entry.path().filename().string().starts_with("port_kind=strict")) {
      const std::string key_of_tests = "tests=\"";
      ASSERT_NE(text.find(key_of_tests), std::string::npos);
      text.insert(text.find(key_of_tests) + key_of_tests.size(), "proved by hand; ");
    }
    write_file_atomically(entry.path(), text);
  }
  const SubprocessResult edited = run_maide({"check", file, "--property", "deadlock"});
  EXPECT_THAT(edited.err, HasSubstr("was edited since it was learned; it is used, but its strength "
                                    "is unknown"));
  EXPECT_THAT(edited.err, HasSubstr("sync: learned before"));  // a remark is no edit
  EXPECT_THAT(edited.out, HasSubstr("via: strength unknown"));
}

TEST(LearnedModels, WithoutAChecksumAreRead) {
  const TempDir folder("check-test");
  const std::string file = write_system(folder, "strict");
  ASSERT_EQ(run_maide({"check", file, "--property", "deadlock"}).exit_status, 0);
  for (const auto& entry : fs::directory_iterator(folder.path() / "maide-models")) {
    if (entry.path().extension() != ".dot") continue;
    std::string text = read_file(entry.path());
    const std::size_t begin = text.find("checksum=\"");
    ASSERT_NE(begin, std::string::npos);
    text.erase(begin, text.find('\n', begin) - begin);
    write_file_atomically(entry.path(), text);
  }
  const SubprocessResult old = run_maide({"check", file, "--property", "deadlock"});
  EXPECT_EQ(old.exit_status, 0) << old.err;
  EXPECT_THAT(old.err, Not(HasSubstr("edited")));
  EXPECT_THAT(old.out, Not(HasSubstr("strength unknown")));
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

// A run without any test finds no more of a queue than it starts from. Three messages go through a
// queue of three, `model.dot`; a model that knows of fewer makes the programs hang.
class StartingFromAnOldModel : public testing::Test {
 protected:
  // What `maide check` says; `start_from` is the key with its value, or nothing.
  SubprocessResult check(const std::string& start_from, const std::string& more = "") const {
    const std::string file = (folder_.path() / "system.yaml").string();
    write_file_atomically(file,
                          "models:\n  via:\n    learn: sim:model.dot\n"
                          "    learning: {eq: random-words, max-tests: 0" +
                              start_from + more +
                              "}\n    when_weak: accept\n"
                              "programs:\n  planner: |\n    repeat 3 { via.write; }\n"
                              "  controller: |\n    repeat 3 { via.read -> message; }\n");
    return run_maide({"check", file, "--property", "deadlock"});
  }
  void write_model(const std::string& name, const std::string& text) const {
    write_file_atomically(folder_.path() / name, text);
  }
  std::string queue() const { return read_file(models_ / "strict-3.dot"); }

  const fs::path models_ = fs::path(MAIDE_SOURCE_DIR) / "tests/models";
  const TempDir folder_{"check-test"};
};

TEST_F(StartingFromAnOldModel, FindsWhatThatKnowsAndNotMore) {
  write_model("model.dot", queue());
  write_model("old.dot", queue());
  EXPECT_EQ(check("").exit_status, 1) << "a false alarm";
  fs::remove_all(folder_.path() / "maide-models");
  const SubprocessResult result = check(", start-from: old.dot");
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("starting from an earlier model"));
  // It is the same model without the key.
  const SubprocessResult again = check("");
  EXPECT_EQ(again.exit_status, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("learned before"));
}

TEST_F(StartingFromAnOldModel, TheKeptModelOfAnotherVersionIsOne) {
  write_model("model.dot", queue());
  write_model("old.dot", queue());
  EXPECT_EQ(check(", start-from: old.dot").exit_status, 0);
  write_model("model.dot", "// The next version.\n" + queue());
  const SubprocessResult result = check("");
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("starting from an earlier model"));
}

TEST_F(StartingFromAnOldModel, IsRefusedWhereItCannotBe) {
  write_model("model.dot", queue());
  write_model("coffee.dot", "digraph { __start0 -> a; a -> a [label=\"coin / beep\"]; }");
  fs::copy_file(models_ / "nondeterministic/lossy.dot", folder_.path() / "lossy.dot");
  const auto refused = [&](const std::string& file, const std::string& why,
                           const std::string& more = "") {
    const SubprocessResult result = check(", start-from: " + file, more);
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_THAT(result.err, HasSubstr(why));
    EXPECT_THAT(result.err, HasSubstr("model via: "));
    EXPECT_THAT(result.err, HasSubstr("system.yaml:3:"));
  };
  refused("nothing.dot", (folder_.path() / "nothing.dot").string());
  refused("coffee.dot", "with none of the system's inputs, which are write, read");
  refused("lossy.dot", "lossy.dot)");
  refused("model.dot", "nstar cannot start from an old model", ", algorithm: nstar");
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
  EXPECT_EQ(unwritable.exit_status, 1);
  EXPECT_THAT(unwritable.err, HasSubstr("/no/such"));
}

}  // namespace
}  // namespace maide::test
