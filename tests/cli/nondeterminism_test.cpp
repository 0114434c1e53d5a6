// `maide` on a system that answers the same word in several ways: rejected with what was seen,
// learned by nstar, and the model used by the other commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

const std::string lossy = MAIDE_SOURCE_DIR "/tests/models/nondeterministic/lossy.dot";

TEST(Nondeterminism, IsSaidWithItsAnswersAndWhatToDo) {
  const SubprocessResult result = run_maide({"learn", "sim:" + lossy, "--json"});
  EXPECT_EQ(result.exit_status, 3);
  EXPECT_THAT(result.err, HasSubstr("stays nondeterministic: it answered \""));
  EXPECT_THAT(result.err, HasSubstr("message\""));
  EXPECT_THAT(result.err, HasSubstr("--algorithm nstar"));
  const Json json = json_of(result);
  EXPECT_EQ(json.at("complete"), false);
  ASSERT_FALSE(json.at("contradictions").empty());
  EXPECT_GE(json.at("contradictions")[0].at("answers").size(), 2U);
}

TEST(Nondeterminism, IsLearnedComparedExportedAndChecked) {
  const TempDir folder;
  const std::string model = (folder.path() / "model.dot").string();
  const Json learned =
      json_of(run_maide({"learn", "sim:" + lossy, "--algorithm", "nstar", "-o", model, "--json"}));
  EXPECT_EQ(learned.at("complete"), true);
  EXPECT_EQ(learned.at("algorithm"), "nstar");
  EXPECT_EQ(learned.at("mealy_states"), 2);
  EXPECT_EQ(run_maide({"compare", model, lossy}).exit_status, 0);
  EXPECT_EQ(run_maide({"compare", model, MAIDE_SOURCE_DIR "/tests/models/buffered-tryread.dot"})
                .exit_status,
            1);
  const SubprocessResult exported = run_maide({"export", model, "--to", "promela"});
  EXPECT_EQ(exported.exit_status, 0);
  EXPECT_THAT(exported.out, HasSubstr("InChannel?tryread"));

  // A reader that takes what comes never hangs; one that needs the message may.
  const std::string system = (folder.path() / "system.yaml").string();
  const auto check = [&](const std::string& reader) {
    write_file_atomically(
        system, "models:\n  m: {file: model.dot}\nprograms:\n  p: |\n    " + reader + "\n");
    return run_maide({"check", system, "--engine", "spin"}).exit_status;
  };
  EXPECT_EQ(check("m.write; switch m.tryread { message { } null { } }"), 0);
  EXPECT_EQ(check("m.write; m.tryread -> message;"), 1);
}

// A run that ends early, by a limit as by Ctrl-C, leaves what it knows.
TEST(Nondeterminism, ARunThatIsCutShortKeepsADraft) {
  const TempDir folder;
  const std::string model = (folder.path() / "model.dot").string();
  for (const char* most : {"1", "20", "200"}) {
    const SubprocessResult result = run_maide({"learn", "sim:" + lossy, "--algorithm", "nstar",
                                               "--max-experiments", most, "-o", model, "--json"});
    EXPECT_EQ(result.exit_status, 3);
    EXPECT_THAT(result.err, HasSubstr("stopped at the limit"));
    const Json learned = json_of(result);
    EXPECT_EQ(learned.at("complete"), false);
    EXPECT_EQ(learned.at("model"), model);
    EXPECT_GE(learned.at("transitions"), 1);
    EXPECT_EQ(run_maide({"export", model, "--to", "promela"}).exit_status, 0);
    EXPECT_THAT(read_file(model), HasSubstr("incomplete"));
  }
}

TEST(Nondeterminism, WhatNstarCannotDoIsRefused) {
  expect_error(run_maide({"learn", "sim:" + lossy, "--algorithm", "nstar", "--translation", "av"}),
               2, "eager");
  expect_error(run_maide({"learn", "sim:" + lossy, "--algorithm", "nstar", "--cache", "/tmp/none"}),
               2, "one answer a word");
  expect_error(run_maide({"learn", "sim:" + lossy, "--confidence", "0.999", "--repeat", "12"}), 2,
               "at least 15 attempts");
}

TEST(Nondeterminism, MealyMachinesAreLearnedAndComparedToo) {
  const TempDir folder;
  const std::string coin = (folder.path() / "coin.dot").string();
  const std::string loaded = (folder.path() / "loaded.dot").string();
  const std::string model = (folder.path() / "model.dot").string();
  write_file_atomically(coin,
                        "digraph g { __start0 -> a; a -> b [label=\"toss / done\"];"
                        "a -> a [label=\"look / heads\"]; b -> b [label=\"toss / done\"];"
                        "b -> a [label=\"look / heads\"]; b -> c [label=\"look / tails\"];"
                        "c -> b [label=\"toss / done\"]; c -> c [label=\"look / tails\"]; }");
  write_file_atomically(loaded,
                        "digraph g { __start0 -> a; a -> a [label=\"toss / done\"];"
                        "a -> a [label=\"look / heads\"]; }");
  const SubprocessResult learned =
      run_maide({"learn", "sim:" + coin, "--algorithm", "nstar", "-o", model});
  EXPECT_EQ(learned.exit_status, 0);
  EXPECT_EQ(run_maide({"compare", model, coin}).exit_status, 0);
  const SubprocessResult differ = run_maide({"compare", coin, loaded});
  EXPECT_EQ(differ.exit_status, 1);
  EXPECT_THAT(differ.out, HasSubstr("toss / done\n  coin.dot may answer heads or tails\n"
                                    "  loaded.dot may answer heads\n"));
  EXPECT_EQ(run_maide({"export", model, "--to", "promela"}).exit_status, 0);
  expect_error(run_maide({"export", model, "--to", "smv"}), 2, "nondeterministic");
}

TEST(Nondeterminism, ARealSystemIsConfirmedWithLongerWaits) {
  const Json json = json_of(run_maide({"learn", "port", "kind=strict", "size=1", "--json"}));
  EXPECT_EQ(json.at("complete"), true);
  EXPECT_THAT(json.at("guarantee").get<std::string>(),
              HasSubstr("words confirmed with longer waits (floor=10)"));
  EXPECT_GT(json.at("confirmation_experiments"), 0);
  const Json plain =
      json_of(run_maide({"learn", "port", "kind=strict", "size=1", "--confirm", "no", "--json"}));
  EXPECT_EQ(plain.at("confirmation_experiments"), 0);
  EXPECT_EQ(plain.at("symbols").get<int>() + json.at("confirmation_symbols").get<int>(),
            json.at("symbols").get<int>());
}

}  // namespace
}  // namespace maide::test
