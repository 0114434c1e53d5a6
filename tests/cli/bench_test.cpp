// `maide bench` with the real program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string models = MAIDE_SOURCE_DIR "/tests/models";

// A machine of two states that a single look at each input does not tell from one of one state.
constexpr const char* lamp =
    "digraph { off -> on [label=\"press / quiet\"]; off -> off [label=\"look / dark\"];"
    "on -> off [label=\"press / quiet\"]; on -> on [label=\"look / light\"]; }";

TEST(Bench, EveryLearnerLearnsEveryModelOfAFolder) {
  const TempDir folder;
  const std::string csv = folder.path() / "bench.csv";
  const SubprocessResult result = run_maide({"bench", models, "--csv", csv, "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json json = json_of(result);
  EXPECT_EQ(json.at("complete"), true);
  EXPECT_EQ(json.at("equivalence_method"), "perfect");
  const std::size_t learners = json.at("means").size();
  EXPECT_GE(learners, 7U);
  EXPECT_EQ(json.at("runs").size(), 13 * learners);
  for (const Json& run : json.at("runs")) {
    EXPECT_EQ(run.at("outcome"), "right") << run;
    EXPECT_EQ(run.at("learned_states"), run.at("states"));
    EXPECT_LE(run.at("to_system").at("symbols"), run.at("asked").at("symbols")) << run;
    EXPECT_EQ(run.at("to_system").at("test_symbols"), 0) << "the perfect oracle sends nothing";
  }
  const std::string written = read_file(csv);
  EXPECT_EQ(static_cast<std::size_t>(std::count(written.begin(), written.end(), '\n')),
            13 * learners + 1);
}

TEST(Bench, CountsDoNotDependOnTheNumberOfJobs) {
  const auto run = [](const std::string& jobs) {
    Json json = json_of(run_maide({"bench", models, "--jobs", jobs, "--json", "--algorithm",
                                   "lsharp", "--eq", "random-words"}));
    for (Json& row : json.at("runs")) row.erase("cpu_seconds");
    for (Json& row : json.at("means")) row.erase("cpu_seconds_in_all");
    return json;
  };
  const Json alone = run("1");
  EXPECT_GT(alone.at("runs").at(0).at("to_system").at("test_symbols"), 0);
  EXPECT_EQ(alone, run("3"));
}

TEST(Bench, WithoutACacheEverythingThatIsAskedReachesTheSystem) {
  const Json json =
      json_of(run_maide({"bench", models, "--no-cache", "--algorithm", "rs", "--json"}));
  for (const Json& run : json.at("runs")) EXPECT_EQ(run.at("to_system"), run.at("asked"));
}

TEST(Bench, PrintsATableWithMeans) {
  const SubprocessResult result = run_maide({"bench", models, "--algorithm", "lsharp"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("strict-6 8x2"));
  EXPECT_THAT(result.out, HasSubstr("Means of the 13 models that every learner learned rightly"));
}

TEST(Bench, AModelThatCannotBeReadIsOneLineAndTheOthersAreMeasured) {
  const TempDir folder;
  write_file_atomically(folder.path() / "broken.dot", "digraph {\n  a -> }");
  write_file_atomically(folder.path() / "lamp.dot", lamp);
  const SubprocessResult result = run_maide({"bench", folder.path().string(), "--algorithm", "rs"});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("broken.dot:2:8)"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  EXPECT_THAT(result.out, HasSubstr("lamp 2x2"));
}

TEST(Bench, FilesThatDifferInTheirExtensionAreToldApart) {
  const TempDir folder;
  for (const char* name : {"lamp.dot", "lamp.gv", "other.dot"}) {
    write_file_atomically(folder.path() / name, lamp);
  }
  const SubprocessResult result = run_maide({"bench", folder.path().string(), "--algorithm", "rs"});
  EXPECT_THAT(result.out, HasSubstr("lamp.dot 2x2"));
  EXPECT_THAT(result.out, HasSubstr("lamp.gv 2x2"));
  EXPECT_THAT(result.out, HasSubstr("other 2x2"));
}

TEST(Bench, AModelWithoutInputsIsOneLineAndTheOthersAreMeasured) {
  const TempDir folder;
  write_file_atomically(folder.path() / "mute.dot", "digraph { __start0 -> s0; }");
  write_file_atomically(folder.path() / "lamp.dot", lamp);
  const SubprocessResult result = run_maide({"bench", folder.path().string(), "--algorithm", "rs"});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("mute.dot)"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  EXPECT_THAT(result.out, HasSubstr("lamp 2x2"));
}

TEST(Bench, EquivalenceMethodsCanBeAskedInTurn) {
  const TempDir folder;
  write_file_atomically(folder.path() / "lamp.dot", lamp);
  const auto run = [&](const std::string& methods) {
    return run_maide({"bench", folder.path().string(), "--algorithm", "rs", "--eq", methods});
  };
  const SubprocessResult right = run("random-words:max-tests=0,w:extra-states=1");
  EXPECT_EQ(right.exit_status, 0) << right.out << right.err;
  EXPECT_EQ(run("random-words:max-tests=0,w:max-tests=0").exit_status, 1) << "nothing is tested";
  expect_error(run("w:seed=3"), 2, "the equivalence method 'w' has no option 'seed'");
}

// One test of one input cannot find the second state.
TEST(Bench, AWrongModelIsSaidToBeWrong) {
  const TempDir folder;
  write_file_atomically(folder.path() / "lamp.dot", lamp);
  const SubprocessResult result = run_maide(
      {"bench", folder.path().string(), "--algorithm", "rs", "--eq", "w", "--max-tests", "0"});
  EXPECT_EQ(result.exit_status, 1) << result.out;
  EXPECT_THAT(result.out, HasSubstr("WRONG"));
  EXPECT_THAT(result.out, Not(HasSubstr("Means")));
}

TEST(Bench, ARunThatReachesItsLimitIsUnfinished) {
  const SubprocessResult result =
      run_maide({"bench", models, "--algorithm", "rs", "--max-experiments", "3", "--json"});
  EXPECT_EQ(result.exit_status, 3);
  const Json run = json_of(result).at("runs").at(0);
  EXPECT_EQ(run.at("outcome"), "unfinished");
  EXPECT_EQ(run.at("to_system").at("resets"), 3);
  EXPECT_FALSE(run.at("error").get<std::string>().empty());
}

// From itself L# needs one hypothesis, and from a model of another name none is started.
TEST(Bench, LearnersStartFromModelsOfEarlierVersions) {
  const TempDir folder;
  for (const char* name : {"strict-6.dot", "strict-4.dot"}) {
    std::filesystem::copy_file(models + "/" + name, folder.path() / name);
  }
  const std::string old = folder.path().string();
  const Json json = json_of(run_maide({"bench", models, "--start-from", old, "--json"}));
  EXPECT_EQ(json.at("start_from"), old);
  std::size_t started = 0;
  for (const Json& run : json.at("runs")) {
    EXPECT_EQ(run.at("outcome"), "right") << run;
    const bool has_old = run.at("model") == "strict-6" || run.at("model") == "strict-4";
    EXPECT_EQ(run.at("old_states"), has_old ? run.at("states") : Json()) << run;
    if (!has_old) continue;
    ++started;
    EXPECT_LE(run.at("equivalence_queries"), run.at("algorithm") == "lsharp" ? 1 : 4) << run;
  }
  EXPECT_EQ(started, 2 * json.at("means").size());
  EXPECT_THAT(run_maide({"bench", old, "--start-from", models, "--algorithm", "rs"}).out,
              HasSubstr("strict-6 8x2, from 8"));
}

TEST(Bench, FoldersWithoutEarlierVersionsAreRefused) {
  const TempDir folder;
  write_file_atomically(folder.path() / "lamp.dot", lamp);
  const std::string old = folder.path().string();
  expect_error(run_maide({"bench", models, "--start-from", old}), 2,
               "no model has the name of one to be learned (" + old + ")");
  expect_error(run_maide({"bench", models, "--start-from", old + "/no"}), 2, old + "/no");
  std::filesystem::rename(folder.path() / "lamp.dot", folder.path() / "strict-6.dot");
  const SubprocessResult result =
      run_maide({"bench", models, "--start-from", old, "--algorithm", "rs"});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("the earlier version of strict-6 has none of its inputs"));
  EXPECT_THAT(result.out, HasSubstr("strict-6 8x2 "));
}

TEST(Bench, WhatCannotBeUsedIsAnError) {
  const TempDir folder;
  const std::string path = folder.path().string();
  expect_error(run_maide({"bench", path + "/nothing"}), 2, "there is no such folder");
  expect_error(run_maide({"bench", path}), 2, "no model files are there");
  expect_error(run_maide({"bench", models, "--algorithm", "x"}), 2, "'x' is none of lsharp, ");
  expect_error(run_maide({"bench", models, "--eq", "x"}), 2, "unknown equivalence method 'x'");
}

}  // namespace
}  // namespace maide::test
