// How strong a model is, as a person meets it: weak models are called so first, a strength that was
// demanded is reached or costs the exit status, verdicts say what they lean on.
#include "maide/automata/strength.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/learn_report.hpp"
#include "maide/formats/model_file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string strict_3 = std::string("sim:") + MAIDE_SOURCE_DIR + "/tests/models/strict-3.dot";

class StrengthOfLearning : public testing::Test {
 protected:
  // hads alone pumps nothing, so its models are weak.
  SubprocessResult learn(const std::vector<std::string>& more,
                         const std::string& method = "hads:extra-states=2") const {
    std::vector<std::string> arguments{"learn", strict_3, "--eq", method};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_maide(arguments);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  const TempDir folder_{"strength-test"};
};

TEST_F(StrengthOfLearning, AWeakModelIsCalledSoFirst) {
  const std::string model = path("model.dot");
  const SubprocessResult to_file = learn({"-o", model});
  EXPECT_EQ(to_file.exit_status, 0) << to_file.err;
  const std::string first = to_file.out.substr(0, to_file.out.find('\n'));
  EXPECT_THAT(first, StartsWith("WEAK: parts of the system may be missing from this model."));
  EXPECT_THAT(first, HasSubstr("all rows of 3 inputs that change nothing there one by one "
                               "(reached: 0)"));
  EXPECT_THAT(first, HasSubstr("such an input 64 times in a row (reached: 0)"));
  EXPECT_THAT(first, Not(HasSubstr("states more"))) << "two were reached";
  EXPECT_THAT(to_file.out, HasSubstr("  strength             weak: extra-states=2,chained=0,"));

  const SubprocessResult to_stdout = learn({});
  EXPECT_THAT(to_stdout.err, StartsWith("WEAK: "));
  EXPECT_THAT(to_stdout.out, StartsWith("digraph "));
  EXPECT_THAT(learn({"-q", "-o", model}).out, HasSubstr("transitions (weak)\n"));
  const SubprocessResult quiet = learn({"-q"});
  EXPECT_THAT(quiet.out, StartsWith("digraph "));
  EXPECT_EQ(quiet.err, "maide: the model is weak\n");
}

TEST_F(StrengthOfLearning, TheCommandThatGoesOnCanBeTyped) {
  const std::string model = path("model.dot");
  const std::string out = learn({"-o", model, "--seed", "7"}).out;
  const std::string first = out.substr(0, out.find('\n'));
  const std::size_t command = first.find("Go on: maide learn ");
  ASSERT_NE(command, first.npos) << first;
  const std::vector<std::string> words = split_shell_words(first.substr(command + 7));
  EXPECT_EQ(words, (std::vector<std::string>{"maide", "learn", strict_3, "--output", model,
                                             "--seed", "7", "--start-from", model}));
  const SubprocessResult next = run_maide({words.begin() + 1, words.end()});
  EXPECT_EQ(next.exit_status, 0) << next.err;
}

TEST_F(StrengthOfLearning, AnExactModelIsNotWeak) {
  const SubprocessResult result = learn({"-o", path("model.dot")}, "perfect");
  EXPECT_THAT(result.out, StartsWith(strict_3));
  EXPECT_THAT(result.out, HasSubstr("  strength             exact\n"));
  const Json json = json_of(learn({"--json"}, "perfect"));
  EXPECT_EQ(json.at("strength").at("weak"), false);
  EXPECT_EQ(json.at("strength").at("exact"), true);
  EXPECT_TRUE(json.at("strength").at("extra_states").is_null());
}

TEST_F(StrengthOfLearning, IsInJsonAndInTheModelFile) {
  const std::string model = path("model.dot");
  const Json json = json_of(learn({"--json", "-o", model}));
  EXPECT_EQ(
      json.at("strength"),
      Json({{"weak", true}, {"extra_states", 2}, {"chained", 0}, {"pumped", 0}, {"random", 0}}));
  EXPECT_EQ(json.at("strength_demanded").at("extra_states"), 1);
  EXPECT_EQ(json.at("strength_demanded").at("chained"), 3);
  EXPECT_EQ(json.at("strength_demanded").at("pumped"), 64);
  EXPECT_THAT(json.at("strength_missing").get<std::string>(), StartsWith("chained=3,pumped=64,"));
  const Origin origin = read_interface_automaton(model).origin;
  EXPECT_EQ(origin.at("strength"), "weak: extra-states=2,chained=0,pumped=0,random=0");
  EXPECT_EQ(origin.at("maide"), version());
}

TEST_F(StrengthOfLearning, WhatIsDemandedIsReachedOrTheStatusSaysSo) {
  EXPECT_EQ(learn({"--strength", "extra-states=2,chained=0,pumped=0,random=0", "-q"}).exit_status,
            0);
  const SubprocessResult missed =
      learn({"--strength", "extra-states=3,chained=0,pumped=0,random=0", "-o", path("m.dot")});
  EXPECT_EQ(missed.exit_status, 3);
  EXPECT_EQ(
      missed.err,
      "maide: the tests did not reach what --strength demands: extra-states=3 (reached: 2)\n");
  EXPECT_TRUE(std::filesystem::exists(path("m.dot")));
}

// A lower demand is met, and the model is weak all the same: the first line says that both are so.
TEST_F(StrengthOfLearning, AModelThatIsWeakAsWasAskedForIsCalledSo) {
  const SubprocessResult met =
      learn({"--strength", "extra-states=2,chained=0,pumped=0,random=0", "-o", path("model.dot")});
  EXPECT_EQ(met.exit_status, 0) << met.err;
  EXPECT_THAT(met.out, StartsWith("WEAK, as --strength allows: parts of the system may be"));
  EXPECT_THAT(met.out, HasSubstr(". Go on: maide learn " + strict_3 + " --output " +
                                 path("model.dot") + " --start-from " + path("model.dot") + "\n"));
  EXPECT_THAT(met.out, HasSubstr("strength             weak: extra-states=2,"));
}

// The tests of a model that is not weak may have missed what is demanded beyond that.
TEST_F(StrengthOfLearning, ADemandThatIsNotReachedSaysHowToGoOn) {
  const std::string model = path("model.dot");
  const std::vector<std::string> arguments{"learn",      strict_3,          "--max-tests", "20000",
                                           "--strength", "extra-states=15", "-o",          model};
  const SubprocessResult missed = run_maide(arguments);
  EXPECT_EQ(missed.exit_status, 3);
  EXPECT_THAT(missed.out, Not(HasSubstr("WEAK")));
  EXPECT_THAT(missed.err, StartsWith("maide: the tests did not reach what --strength demands: "
                                     "extra-states=15 (reached: "));
  EXPECT_THAT(missed.err, EndsWith("). Go on: maide learn " + strict_3 + " --output " + model +
                                   " --strength extra-states=15 --start-from " + model + "\n"));
  std::vector<std::string> with_json = arguments;
  with_json.emplace_back("--json");
  const Json json = json_of(run_maide(with_json));
  EXPECT_EQ(json.at("status"), 3);
  EXPECT_THAT(json.at("error").get<std::string>(), HasSubstr("Go on: maide learn"));
}

TEST_F(StrengthOfLearning, ADemandThatIsNoneIsFoundBeforeTheSystemIsStarted) {
  const std::string trace = path("started");
  const std::string system = "exec:sh -c 'touch " + trace + "'";
  for (const char* demand : {"strong", "extra-states=x", "depth=3", "pumped=1,"}) {
    expect_error(run_maide({"learn", system, "--strength", demand}), 2, "is no strength");
  }
  for (const char* effort : {"0", "1001", "x"}) {
    expect_error(run_maide({"learn", system, "--effort", effort}), 2, "--effort");
  }
  EXPECT_FALSE(std::filesystem::exists(trace));
}

TEST_F(StrengthOfLearning, OptionsThatNoMethodLooksAtAreRefused) {
  expect_error(learn({"--infix-mean", "3"}, "w"), 2,
               "no equivalence method of 'w' has the option 'infix-mean'; w has: extra-states "
               "max-tests");
  expect_error(learn({"--max-tests", "3"}, "perfect"), 2, "perfect has: none");
  expect_error(learn({"--walk-length", "3"}, "w,random-w"), 2, "; random-w has: ");
  expect_error(learn({"--effort", "2"}, "w"), 2,
               "no equivalence method of 'w' has the option 'effort'");
  expect_error(run_maide({"learn", strict_3, "--algorithm", "nstar", "--ways", "2"}), 2,
               "the tests of nstar have no option 'ways'");
  EXPECT_EQ(learn({"--infix-mean", "3", "--max-tests", "9", "-q"}, "w,random-w").exit_status, 0);
  const TempDir folder("strength-test");
  std::filesystem::copy_file(strict_3.substr(4), folder.path() / "model.dot");
  expect_error(run_maide({"bench", folder.path().string(), "--max-tests", "3"}), 2,
               "no equivalence method of 'perfect' has the option 'max-tests'");
}

TEST_F(StrengthOfLearning, OfARunThatEndedEarlyIsNone) {
  const SubprocessResult result = learn({"--max-experiments", "20", "-o", path("model.dot")});
  EXPECT_EQ(result.exit_status, 3);
  EXPECT_THAT(result.out, StartsWith("WEAK: this model was not tested to the end"));
  EXPECT_THAT(result.out, Not(HasSubstr("Go on: maide learn " + strict_3 +
                                        " --eq hads "
                                        "--max-experiments")));
  const Json json = json_of(learn({"--max-experiments", "20", "--json"}));
  EXPECT_EQ(json.at("strength").at("weak"), true);
  EXPECT_TRUE(json.at("strength").at("extra_states").is_null());
  EXPECT_THAT(json.at("dot").get<std::string>(),
              HasSubstr("strength=\"weak: chained=0,pumped=0,random=0\""));
}

// The last equivalence query ends early; the suites that came to their end count.
TEST_F(StrengthOfLearning, OfARunThatEndedInItsLastTestsIsWhatThoseReached) {
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "learn", std::string("sim:") + MAIDE_SOURCE_DIR + "/tests/models/strict-3-tryread.dot",
        "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_maide(arguments);
  };
  const Json whole = json_of(run({}));
  const auto experiments = whole.at("experiments").get<std::uint64_t>();
  const SubprocessResult ended = run({"--max-experiments", std::to_string(experiments - 1)});
  EXPECT_EQ(ended.exit_status, 3);
  const Json json = json_of(ended);
  EXPECT_EQ(json.at("complete"), false);
  for (const char* dimension : {"extra_states", "chained", "random"}) {
    EXPECT_EQ(json.at("strength").at(dimension), whole.at("strength").at(dimension)) << dimension;
  }
  EXPECT_THAT(json.at("guarantee").get<std::string>(),
              HasSubstr("not tested to the end; not refuted by "));
  EXPECT_EQ(json.at("status"), 3);
  EXPECT_EQ("maide: " + json.at("error").get<std::string>() + "\n", ended.err);
}

TEST_F(StrengthOfLearning, InputsThatNeverHadAnEffectAreNamed) {
  std::string machine =
      "digraph g { __start0 -> a; a -> b [label=\"go / x\"]; b -> a [label=\"go "
      "/ y\"];\n";
  for (int i = 1; i <= 12; ++i) {
    for (const char state : {'a', 'b'}) {
      machine += std::string(1, state) + " -> " + state + " [label=\"in" + std::to_string(i) +
                 " / " + state + "\"];\n";
    }
  }
  write_file_atomically(path("machine.dot"), machine + "}");
  const std::vector<std::string> arguments{
      "learn", "sim:" + path("machine.dot"), "--eq", "perfect", "-o", path("model.dot")};
  EXPECT_THAT(run_maide(arguments).out,
              HasSubstr("12 of 13 inputs never had an effect: in1, in2, in3, in4, in5, in6, in7, "
                        "in8, in9, in10 and 2 more\n"));
  const Json json = json_of(learn({"--json"}, "perfect"));
  EXPECT_TRUE(json.at("inputs_without_effect").empty());
  std::vector<std::string> with_json = arguments;
  with_json.emplace_back("--json");
  EXPECT_EQ(json_of(run_maide(with_json)).at("inputs_without_effect").size(), 12U);
}

// A run whose default tests ended with nothing pumped, for want of a budget.
ExperimentResult starved_run(const TestCost& cost, std::uint64_t effort) {
  ExperimentResult run;
  run.strength = TestedStrength{.strength = {.extra_states = 3, .chained = 3, .random = 5000},
                                .standard = {},
                                .demand = {},
                                .cost_of_missing = cost,
                                .budget = {20'000 * effort, 1'000'000 * effort},
                                .is_weak = true};
  run.seconds = 10;
  run.resets = 1000;
  run.symbols = 10'000;
  run.seconds_in_reset_wait = 3;
  run.seconds_in_system = 1;
  return run;
}

TEST(StrengthReport, SaysWhatIsMissingWouldCost) {
  // 7.5 s of the ten for a thousand resets, 2.5 s for ten thousand symbols.
  EXPECT_EQ(cli::describe_weakness(starved_run({4000, 120'000}, 1)),
            "WEAK: parts of the system may be missing from this model. Not tried: in every state, "
            "such an input 64 times in a row (reached: 0). That would cost some 4000 words, 120000 "
            "symbols, 60 s at the speed of this run");
  ExperimentResult cached = starved_run({4000, 120'000}, 1);
  cached.resets = cached.symbols = 0;
  EXPECT_THAT(cli::describe_weakness(cached), EndsWith("4000 words, 120000 symbols"));
  EXPECT_THAT(cli::describe_weakness(starved_run({}, 1)), EndsWith("(reached: 0)"));
  ExperimentResult strong = starved_run({4000, 120'000}, 1);
  strong.strength->is_weak = false;
  EXPECT_EQ(cli::describe_weakness(strong), "");
}

TEST(StrengthReport, TheNextEffortPaysForWhatIsMissing) {
  cli::CommandLine typed("maide learn", "");
  std::string sul, cache;
  std::vector<std::string> settings;
  std::uint64_t effort = 1;
  bool json = false;
  typed.add("SUL", sul, "");
  typed.add("KEY=VALUE", settings, "");
  typed.add("--cache", cache, "");
  typed.add("--effort", effort, "");
  typed.add_flag("--json", json, "");
  typed.parse({"port", "kind=strict", "size=9", "--json", "--cache", "my answers", "--effort", "2"},
              "");
  const auto next = [&](const TestCost& cost, std::uint64_t now, const std::string& model = "") {
    return cli::describe_next_command(typed, starved_run(cost, now), {now, model});
  };
  const std::string line = "maide learn port kind=strict size=9 --cache 'my answers' --json";
  EXPECT_EQ(next({30'000, 5}, 1), line + " --effort 3");
  EXPECT_EQ(next({5, 4'500'000}, 2, "m.dot"), line + " --start-from m.dot --effort 7");
  EXPECT_EQ(next({5, 5}, 100), line + " --effort 200");
  EXPECT_EQ(next({}, 7), line + " --effort 70") << "the cost is not known";
  EXPECT_EQ(next({}, 400), line + " --effort 1000");
  EXPECT_EQ(next({}, 1000), "") << "there is no more";
  EXPECT_EQ(next({30'000'000, 5}, 1), "");
}

// Two programs over a queue of which the file says how strong it is.
class StrengthOfVerdicts : public testing::Test {
 protected:
  SubprocessResult check(const std::string& strength, const std::string& more = "",
                         const std::string& programs = "  p: via.write;\n") const {
    std::string model = read_file(strict_3.substr(4));
    if (!strength.empty()) {
      model.insert(model.find("inputs="), "strength=\"" + strength + "\";\n  ");
    }
    write_file_atomically(folder_.path() / "model.dot", model);
    const std::filesystem::path file = folder_.path() / "system.yaml";
    write_file_atomically(file, "models:\n  via: {file: model.dot" + more +
                                    "}\n  other: {file: model.dot}\nprograms:\n" + programs);
    return run_maide({"check", file.string(), "--property", "deadlock", "--json"});
  }
  const TempDir folder_{"strength-test"};
};

const std::string weak = "weak: extra-states=1,chained=0,pumped=0,random=5";

TEST_F(StrengthOfVerdicts, HoldsOverAWeakModelIsInconclusive) {
  const SubprocessResult result = check(weak);
  EXPECT_EQ(result.exit_status, 3);
  const Json report = json_of(result);
  EXPECT_EQ(report.at("verdict"), "inconclusive");
  const std::string reason = report.at("properties").at(0).at("reason");
  EXPECT_THAT(reason, StartsWith("it leans on a weak model (via), whose tests"));
  EXPECT_THAT(reason,
              HasSubstr("`maide learn SUL --start-from model.dot -o model.dot --effort 10`"));
  EXPECT_THAT(reason, HasSubstr("`when_weak: accept`"));
  EXPECT_THAT(report.at("assumptions").dump(),
              HasSubstr("via is weak: its tests reached extra-states=1,chained=0"));
}

TEST_F(StrengthOfVerdicts, AcceptedWeaknessLeavesTheVerdict) {
  const SubprocessResult result = check(weak, ", when_weak: accept");
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(json_of(result).at("assumptions").dump(),
              HasSubstr("via is weak and accepted (when_weak: accept)"));
  EXPECT_EQ(check(weak, ", when_weak: inconclusive").exit_status, 3);
  const SubprocessResult wrong = check(weak, ", when_weak: never");
  EXPECT_EQ(wrong.exit_status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'when_weak' is one of inconclusive, accept, not 'never'"));
}

TEST_F(StrengthOfVerdicts, UnknownStrengthIsSaidAndChangesNothing) {
  const SubprocessResult unknown = check("");
  EXPECT_EQ(unknown.exit_status, 0);
  EXPECT_THAT(json_of(unknown).at("assumptions").dump(), HasSubstr("via: strength unknown"));
  const SubprocessResult strong = check("extra-states=1,chained=3,pumped=64,random=4000");
  EXPECT_EQ(strong.exit_status, 0);
  EXPECT_THAT(json_of(strong).at("assumptions").dump(), Not(HasSubstr("strength")));
}

TEST_F(StrengthOfVerdicts, WhatAFileDoesNotSayOfItsStrengthIsUnknown) {
  const SubprocessResult result = check("extra-states=1");
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(
      json_of(result).at("assumptions").dump(),
      HasSubstr("via: strength unknown, for the model does not say chained, pumped, random"));
  EXPECT_THAT(json_of(check("extra-states=3,chained=3,pumped=64")).at("assumptions").dump(),
              Not(HasSubstr("strength")))
      << "three extra states stand in for random tests";
  EXPECT_THAT(json_of(check("exact")).at("assumptions").dump(), Not(HasSubstr("strength")));
}

TEST_F(StrengthOfVerdicts, ViolatedStaysViolated) {
  EXPECT_EQ(check(weak, "",
                  "  p: repeat 4 { via.write; }\n  q: via.read -> message; other.read;\n"
                  "    other.read -> message;\n")
                .exit_status,
            1);
}

TEST_F(StrengthOfVerdicts, AMalformedStrengthIsOneErrorWithItsPlace) {
  const SubprocessResult result = check("weak: very");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("attribute 'strength': 'very' is no strength"));
  EXPECT_THAT(result.err, HasSubstr("model.dot:4:12"));
}

}  // namespace
}  // namespace maide::test
