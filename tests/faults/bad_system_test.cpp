// Systems that hang, crash or throw behind a wrapper of the SDK: the words' ends, restarts, errors.
#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;

// For systems that do hang; longer than anything else takes, whatever the load.
const Options::value_type quick = {"step-limit", "1000"};
const Options quickly = {quick};

const char* const program = MAIDE_BINARY_DIR "/bin/bad_wrapper";

// Runs the word three times; its answers, each as "outputs attempts".
std::string outcome(const std::vector<std::string>& word, const Options& options = {}) {
  const auto sul = spawn_wrapper({program}, options);
  SulQuery query = {Word(), Translation::eager};
  for (const std::string& name : word) {
    for (Symbol input = 0; input < sul->info().inputs.size(); ++input) {
      if (sul->info().inputs[input].name == name) std::get<Word>(query.inputs).push_back(input);
    }
  }
  EXPECT_EQ(std::get<Word>(query.inputs).size(), word.size());
  std::string text;
  try {
    sul->run(std::vector<SulQuery>(3, query),
             [&](std::size_t, const SulAnswer& answer) {
               for (const SulStep& step : answer.steps) {
                 text +=
                     mealy_output(step, Translation::eager) + (step.busy.empty() ? "" : "*") + ' ';
               }
               text += std::to_string(answer.attempts) + "; ";
             },
             {});
  } catch (const WrapperError& error) {
    text += error.what();
  }
  return text;
}

TEST(BadSystem, GoodWordsAreGood) { EXPECT_EQ(outcome({"work"}), "done 1; done 1; done 1; "); }

TEST(BadSystem, ACallThatCannotBeUnblockedCostsAProcessOnly) {
  EXPECT_EQ(outcome({"work", "stick", "work"}, quickly),
            "done quiet* refused 1; done quiet* refused 1; done quiet* refused 1; ");
}

TEST(BadSystem, ASystemThatNeverRestsHangs) {
  EXPECT_EQ(outcome({"spin", "work"}, quickly), "hang 2; hang 2; hang 2; ");
}

TEST(BadSystem, ACrashThatTheWrapperSeesEndsTheWord) {
  EXPECT_EQ(outcome({"work", "crash", "work"}), "done crash 3; done crash 3; done crash 3; ");
}

TEST(BadSystem, ACrashOfTheProcessIsAnAnswer) {
  EXPECT_EQ(outcome({"work", "abort"}), "done crash 3; done crash 3; done crash 3; ");
}

TEST(BadSystem, AnExceptionNamesTheWord) {
  EXPECT_EQ(outcome({"throw"}),
            std::string("the lamp fell, in the word \"throw\" (") + program + ")");
}

TEST(BadSystem, AnUndeclaredEventNamesTheWord) {
  EXPECT_EQ(outcome({"invent"}),
            std::string("the wrapper reported event 'rain', which it did not declare, in the word "
                        "\"invent\" (") +
                program + ")");
}

TEST(BadSystem, WhatItPrintsDoesNotReachTheProtocol) {
  EXPECT_EQ(outcome({"print", "work"}), "quiet done 1; quiet done 1; quiet done 1; ");
}

TEST(BadSystem, AResetThatAlwaysHangsIsNoSystem) {
  EXPECT_EQ(outcome({"work"}, {{"reset", "hang"}, quick}),
            std::string("the reset did not end in time; it did so 3 times in the reset before the "
                        "word \"work\" (") +
                program + ")");
}

TEST(BadSystem, AResetThatFailsSaysWhy) {
  EXPECT_EQ(outcome({"work"}, {{"reset", "throw"}}),
            std::string("no more lamps, in the word \"work\" (") + program + ")");
}

TEST(BadSystem, ATeardownThatHangsCostsAProcessOnly) {
  EXPECT_EQ(outcome({"work"}, {{"teardown", "hang"}, quick}), "done 1; done 1; done 1; ");
}

}  // namespace
}  // namespace maide
