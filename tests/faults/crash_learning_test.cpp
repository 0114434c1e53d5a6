// Systems whose crash, or hang, is a part of their behaviour: it is a part of the model, exactly
// there, however it happens, in both translations, by every learner; and no word is run that is
// known to end so.
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "fragile_systems.hpp"
#include "maide/automata/compare.hpp"
#include "maide/base/file.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/learn/learner.hpp"
#include "maide/wire/client/child_process.hpp"
#include "processes.hpp"

namespace maide {
namespace {

using test::Options;

struct Case {
  std::string name, death, algorithm;
  Translation translation = Translation::eager;
  std::string teardown = "good";
};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }

class FragileSystem : public testing::TestWithParam<Case> {};

TEST_P(FragileSystem, IsLearnedWithItsEnd) {
  const Case& tested = GetParam();
  const bool hangs = tested.death == "hang";
  Options options = {{"death", tested.death}, {"teardown", tested.teardown}};
  if (hangs || tested.teardown == "hang") options["step-limit"] = "1000";
  ExperimentOptions experiment;
  experiment.algorithm = tested.algorithm;
  experiment.test_method = hangs ? "random-words" : "standard";
  experiment.testing.max_tests = hangs ? 20 : 220;  // a hang takes its time
  const test::ProcessMark mark;
  const LearnedModel learned = test::learn_lamp(options, tested.translation, experiment);
  const auto& automaton = std::get<InterfaceAutomaton>(*learned.model);
  const std::string end = hangs ? "hang" : "crash";
  EXPECT_TRUE(compare(automaton, test::make_lamp(end)).same());
  EXPECT_EQ(automaton.size(), 7U);
  EXPECT_TRUE(automaton.hidden_returns.empty());
  ASSERT_EQ(learned.ends.size(), 1U);
  EXPECT_EQ(learned.ends[0].output, end);
  EXPECT_EQ(learned.ends[0].word, (std::vector<std::string>{"press", "hit"}));
  EXPECT_EQ(learned.ends[0].states, 1U);
  EXPECT_NE(learned.ends[0].reason, "");
  EXPECT_EQ(automaton.origin.at("ends"), to_string(learned.ends[0]));
  EXPECT_EQ(learned.incidents.count > 0, tested.teardown != "good");
  while (!mark.find().empty()) std::this_thread::yield();
}

INSTANTIATE_TEST_SUITE_P(
    Deaths, FragileSystem,
    testing::Values(Case{"AbortLmplus", "abort", "lmplus"}, Case{"AbortRs", "abort", "rs"},
                    Case{"AbortLmplusAv", "abort", "lmplus", Translation::av},
                    Case{"AbortRsAv", "abort", "rs", Translation::av},
                    Case{"Segfault", "segfault", ""}, Case{"Exit", "exit", ""},
                    Case{"Kill", "kill", "", Translation::av}, Case{"Memory", "memory", ""},
                    Case{"Seen", "seen", ""}, Case{"Broker", "broker", ""},
                    Case{"BrokerAv", "broker", "", Translation::av}, Case{"Hang", "hang", ""},
                    Case{"HangAv", "hang", "", Translation::av},
                    Case{"TeardownAbort", "abort", "", Translation::eager, "abort"},
                    Case{"TeardownCorrupt", "abort", "", Translation::av, "corrupt"},
                    Case{"TeardownHang", "abort", "", Translation::eager, "hang"}),
    [](const auto& tested) { return tested.param.name; });

// Each death costs a wrapper that has dialled in its process, and it dials again.
TEST(CrashLearning, IsTheSameWithWrappersThatDialIn) {
  const std::string program = MAIDE_BINARY_DIR "/bin/fragile_wrapper";
  SystemAccess access;
  access.accept = "127.0.0.1:" + std::to_string(free_loopback_port());
  const ChildProcess first({program, "--connect", access.accept});
  const ChildProcess second({program, "--connect", access.accept});
  const std::vector<std::string> options{"death=abort"};
  const OpenedSystem system = open_system(parse_system_spec("exec:" + program, options), access);
  const LearnedModel learned = learn_model(*system.sul, Translation::eager, {});
  if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
  EXPECT_TRUE(
      compare(std::get<InterfaceAutomaton>(*learned.model), test::make_lamp("crash")).same());
  EXPECT_EQ(learned.incidents.count, 0U);
  EXPECT_LE(count_systems(*system.sul), 2U);  // none is taken for one more
}

// A run that was ended goes on where it was, and what its cache knows to crash is not run again.
TEST(CrashLearning, ResumesFromACacheWithoutAnotherCrash) {
  for (const Translation translation : {Translation::eager, Translation::av}) {
    const TempDir folder;
    ExperimentOptions experiment;
    experiment.cache_file = folder.path() / "cache";
    experiment.max_experiments = 12;
    EXPECT_THROW(test::learn_lamp({}, translation, experiment), Error);
    experiment.max_experiments = 0;
    const LearnedModel resumed = test::learn_lamp({}, translation, experiment);
    EXPECT_TRUE(
        compare(std::get<InterfaceAutomaton>(*resumed.model), test::make_lamp("crash")).same());
    const LearnedModel known = test::learn_lamp({}, translation, experiment);
    EXPECT_EQ(known.experiment.experiments, 0U);
    EXPECT_TRUE(
        compare(std::get<InterfaceAutomaton>(*known.model), test::make_lamp("crash")).same());
    EXPECT_EQ(known.ends.at(0).word, (std::vector<std::string>{"press", "hit"}));
    EXPECT_EQ(known.ends.at(0).reason, "");  // that no cache keeps
  }
}

// A wrapper that can do nothing any more, not even say so.
TEST(CrashLearning, AStoppedProcessIsAHang) {
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/fragile_wrapper"},
                                 {{"death", "stop"}, {"step-limit", "1000"}});
  IaTranslator translator(*sul, Translation::eager);
  const std::vector<Query> batch = {Word{0, 1, 0}};
  const MealyAnswer answer = translator.run(batch).front();
  EXPECT_EQ(to_string(answer.outputs, translator.outputs()), "on hang refused");
  EXPECT_EQ(answer.attempts, 3U);
  EXPECT_EQ(translator.fatal_words().at(0).reason, "the wrapper hangs: no answer within 2.05 s");
}

// Every crash costs processes, so it is told apart from what is known: here two words run, and
// three more begin with one that crashes.
TEST(CrashLearning, WhatBeginsWithACrashIsNotRunAgain) {
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/fragile_wrapper"});
  IaTranslator translator(*sul, Translation::eager);
  const Symbol press = 0, hit = 1;
  const auto outputs = [&](const MealyAnswer& answer) {
    std::string text;
    for (const Symbol output : answer.outputs) text += translator.outputs().name(output) + " ";
    return text + std::to_string(answer.attempts);
  };
  const std::vector<Query> batch = {Word{press, hit}, Word{hit, hit}, Word{press, hit, press}};
  const std::vector<MealyAnswer> answers = translator.run(batch);
  EXPECT_EQ(outputs(answers[0]), "on crash 3");
  EXPECT_EQ(outputs(answers[1]), "dull dull 1");
  EXPECT_EQ(outputs(answers[2]), "on crash refused 0");
  ASSERT_EQ(translator.fatal_words().size(), 1U);
  EXPECT_EQ(translator.fatal_words()[0].reason, "the wrapper was killed by signal 6 (Aborted)");
  DecisionTree tree;
  const Symbol on = *translator.outputs().find("on");
  const Symbol crash = *translator.outputs().find("crash");
  const Symbol refused = *translator.outputs().find("refused");
  tree.nodes = {{press, {{on, 1}}}, {hit, {{crash, 2}}}, {press, {{refused, 3}}}, {hit, {}}};
  const std::vector<Query> trees = {tree};
  EXPECT_EQ(outputs(translator.run(trees)[0]), "on crash refused refused 0");
}

}  // namespace
}  // namespace maide
