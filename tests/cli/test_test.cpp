// `maide test` with the real program: the reference port against its models, and simulated mutants.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string model(const std::string& name) {
  return MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot";
}

// A file of the folder with this text.
std::string write(const TempDir& folder, const std::string& name, const std::string& text) {
  const std::string path = (folder.path() / name).string();
  write_file_atomically(path, text);
  return path;
}

// Says "1" behind each second `x`; the mutant behind each third.
constexpr const char* every_second =
    "digraph { a -> b [label=\"x / 0\"]; b -> a [label=\"x / 1\"]; "
    "a -> a [label=\"y / 0\"]; b -> b [label=\"y / 0\"] }";
constexpr const char* every_third =
    "digraph { a -> b [label=\"x / 0\"]; b -> c [label=\"x / 0\"]; c -> a [label=\"x / 1\"]; "
    "a -> a [label=\"y / 0\"]; b -> b [label=\"y / 0\"]; c -> c [label=\"y / 0\"] }";

TEST(Test, RefusesWhatCannotBeTested) {
  const TempDir folder;
  const std::string machine = write(folder, "machine.dot", every_second);
  expect_error(run_maide({"test"}), 2, "MODEL is required");
  expect_error(run_maide({"test", "nowhere.dot"}), 2, "nowhere.dot");
  expect_error(run_maide({"test", machine}), 2, "does not say what it was learned from");
  expect_error(run_maide({"test", machine, "nothing"}), 2, "nothing");
  expect_error(run_maide({"test", machine, "sim:" + machine, "--eq", "magic"}), 2, "magic");
  const SubprocessResult both =
      run_maide({"test", machine, "sim:" + machine, "--json", "--junit", "-"});
  EXPECT_EQ(both.exit_status, 2);
  EXPECT_THAT(both.err, HasSubstr("both write to standard output"));
  expect_error(run_maide({"test", machine, "sim:" + machine, "--junit", machine}), 2,
               "would write over a file that is used");
  expect_error(run_maide({"test", machine, "sim:" + machine, "--junit", "/nowhere/x.xml"}), 2,
               "/nowhere/x.xml");
}

TEST(Test, NamesInputsThatTheOtherSideLacks) {
  const TempDir folder;
  const std::string two = write(folder, "two.dot", every_second);
  const std::string one =
      write(folder, "one.dot", "digraph { a -> b [label=\"x / 0\"]; b -> a [label=\"x / 1\"] }");
  expect_error(run_maide({"test", two, "sim:" + one}), 2,
               "lacks inputs that the model has: y (the system's inputs are: x)");
  const SubprocessResult more = run_maide({"test", one, "sim:" + two});
  EXPECT_EQ(more.exit_status, 0);
  EXPECT_THAT(more.out, HasSubstr("not tested inputs that the model does not have: y\n"));
}

TEST(Test, AMutantDiffersInAShortestWord) {
  const TempDir folder;
  const std::string two = write(folder, "two.dot", every_second);
  const std::string three = write(folder, "three.dot", every_third);
  const SubprocessResult same = run_maide({"test", two, "sim:" + two});
  EXPECT_EQ(same.exit_status, 0) << same.err;
  EXPECT_THAT(same.out, StartsWith("Conforms: no test tells sim:" + two + " from two.dot\n"));
  EXPECT_THAT(same.out, HasSubstr("2 of 2 states, 4 of 4 transitions, 8 of 8 pairs"));
  const SubprocessResult differs = run_maide({"test", two, "sim:" + three});
  EXPECT_EQ(differs.exit_status, 1) << differs.err;
  EXPECT_THAT(differs.out, StartsWith("Differs: after x, x: the model gives 1, the system 0\n"));
  EXPECT_THAT(differs.out, HasSubstr("  tests      but for these differences: "));
  const SubprocessResult perfect = run_maide({"test", two, "sim:" + three, "--eq", "perfect"});
  EXPECT_EQ(perfect.exit_status, 1) << perfect.err;
}

TEST(Test, TheModelNamesItsSystem) {
  const TempDir folder;
  write(folder, "system.dot", every_second);
  const std::string named =
      write(folder, "named.dot",
            std::string("digraph { sul=\"sim:system.dot\" versions=\"wrapper 0\"; ") +
                (every_second + sizeof("digraph {") - 1));
  const SubprocessResult result = run_maide({"test", named});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("learned    from other versions (wrapper 0)\n"));
}

TEST(Test, ThePortConformsToItsModelAndNotToALongerOne) {
  const std::vector<std::string> port{"port", "kind=strict", "size=2"};
  const auto test = [&](const std::string& name, const std::string& option) {
    std::vector<std::string> arguments{"test", model(name)};
    arguments.insert(arguments.end(), port.begin(), port.end());
    arguments.insert(arguments.end(), {"--eq", "hads", "--extra-states", "1", option});
    return run_maide(arguments);
  };
  const SubprocessResult same = test("strict-2", "-q");
  EXPECT_EQ(same.exit_status, 0) << same.out << same.err;
  const SubprocessResult longer = test("strict-3", "--json");
  EXPECT_EQ(longer.exit_status, 1) << longer.out << longer.err;
  const Json json = json_of(longer);
  EXPECT_EQ(json.at("verdict"), "differs");
  EXPECT_EQ(json.at("failures").at(0).at("word"), Json::parse(R"(["write", "write", "write"])"));
  EXPECT_EQ(json.at("failures").at(0).at("seen"), "unexplored");
}

TEST(Test, WhatTheModelNeverTriedIsNotJudged) {
  const SubprocessResult shorter =
      run_maide({"test", model("strict-2"), "sim:" + model("strict-3"), "--json", "--eq", "hads"});
  EXPECT_EQ(shorter.exit_status, 0) << shorter.out << shorter.err;
  const Json json = json_of(shorter);
  EXPECT_EQ(json.at("verdict"), "conforms");
  EXPECT_EQ(json.at("covered").at("transitions").at("covered"),
            json.at("covered").at("transitions").at("total"));
}

TEST(Test, JUnitHasACaseForEachTransition) {
  const TempDir folder;
  const std::string two = write(folder, "two.dot", every_second);
  const std::string three = write(folder, "three.dot", every_third);
  const std::string file = (folder.path() / "out.xml").string();
  const SubprocessResult result =
      run_maide({"test", two, "sim:" + three, "--junit", file, "--seed", "7"});
  EXPECT_EQ(result.exit_status, 1);
  const std::string xml = read_file(file);
  EXPECT_THAT(xml, HasSubstr("<testsuite name=\"two\" tests=\"4\" failures="));
  EXPECT_THAT(xml, HasSubstr("<property name=\"seed\" value=\"7\"/>"));
  EXPECT_THAT(xml, HasSubstr("<testcase classname=\"two\" name=\"x, at the start\"/>"));
  EXPECT_THAT(xml, HasSubstr("name=\"x, after x\">\n      <failure message=\"after x, x: the model "
                             "gives 1, the system 0\">word: x x&#10;"));
  const SubprocessResult piped = run_maide({"test", two, "sim:" + three, "--junit", "-"});
  EXPECT_EQ(piped.exit_status, 1);
  EXPECT_THAT(piped.out, StartsWith("<?xml"));
  EXPECT_THAT(piped.err, StartsWith("Differs: "));
}

TEST(Test, JUnitNamesTheStatesOfAnAutomaton) {
  const SubprocessResult result = run_maide(
      {"test", model("strict-2"), "sim:" + model("strict-2"), "--eq", "hads", "--junit", "-"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("name=\"read, state: holds 2\""));
  EXPECT_THAT(result.out, HasSubstr("name=\"write, state: empty, reader waits\""));
}

TEST(Test, APageStepsThroughWhatFails) {
  if (!can_step_through()) GTEST_SKIP() << "needs node (Debian: nodejs)";
  const TempDir folder;
  const std::string page = (folder.path() / "page.html").string();
  const SubprocessResult result =
      run_maide({"test", model("strict-2"), "sim:" + model("buffered"), "--html", page});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  EXPECT_THAT(result.out,
              StartsWith("Differs: after write, write, read, read: the model gives message, the "
                         "system nothing\n"));
  EXPECT_EQ(
      step_through(page, "ArrowRight,ArrowRight,ArrowRight,ArrowRight,ArrowRight"),
      R"(start: difference 1 of 1, step 0 of 4 | 0 ; (start) ;  ;  ; empty | A at empty, B at empty
ArrowRight: difference 1 of 1, step 1 of 4 | 1 ; write ; quiet ; quiet ; holds 1 | A at holds 1, B at holds 1
ArrowRight: difference 1 of 1, step 2 of 4 | 2 ; write ; quiet ; quiet ; holds 2 | A at holds 2 never tried: write, B at holds 2 never tried: write
ArrowRight: difference 1 of 1, step 3 of 4 | 3 ; read ; message ; message ; holds 1 | A at holds 1, B at holds 1
ArrowRight: difference 1 of 1, step 4 of 4 | 4 ; read ; message ; quiet ; empty | A at empty, B at empty
ArrowRight: difference 1 of 1, step 4 of 4 | 4 ; read ; message ; quiet ; empty | A at empty, B at empty
)");
  const std::string text = read_file(page);
  EXPECT_THAT(text, HasSubstr("read / model: message, system: quiet"));
  EXPECT_THAT(text, HasSubstr("Transitions that fail"));
  // Nothing fails: the page shows what was covered, and has nothing to step through.
  EXPECT_EQ(run_maide({"test", model("strict-2"), "sim:" + model("strict-2"), "--eq", "hads",
                       "--html", page})
                .exit_status,
            0);
  EXPECT_THAT(read_file(page), HasSubstr("Conforms: no test tells"));
  EXPECT_THAT(read_file(page), Not(HasSubstr("Transitions that fail")));
  expect_error(run_maide({"test", model("port"), "--html", model("port")}), 2,
               "--html would write over a file that is used");
}

// The words of a cache or a log come first: here they alone find the mistake.
TEST(Test, BeginsWithTheWordsOfTheModel) {
  const TempDir folder;
  const std::string two = write(folder, "two.dot", every_second);
  const std::string three = write(folder, "three.dot", every_third);
  const std::string cache = (folder.path() / "two.cache").string();
  ASSERT_EQ(run_maide({"learn", "sim:" + two, "--cache", cache, "-o",
                       (folder.path() / "out.dot").string()})
                .exit_status,
            0);
  const SubprocessResult same = run_maide({"test", two, "sim:" + two, "--words", cache});
  EXPECT_EQ(same.exit_status, 0) << same.err;
  const std::string log =
      write(folder, "log.jsonl", "[[\"x\", \"0\"], [\"x\", \"1\"]]\n[[\"z\", \"0\"]]\n");
  const std::vector<std::string> one_word{"test", two, "sim:" + three, "--max-tests", "1"};
  EXPECT_EQ(run_maide(one_word).exit_status, 3);
  std::vector<std::string> with_log = one_word;
  with_log.insert(with_log.end(), {"--words", log});
  const SubprocessResult found = run_maide(with_log);
  EXPECT_EQ(found.exit_status, 1) << found.out << found.err;
  EXPECT_THAT(found.out, StartsWith("Differs: after x, x: "));
  expect_error(run_maide({"test", two, "sim:" + two, "--words",
                          write(folder, "z.jsonl", "[[\"z\", \"0\"]]\n")}),
               2, "no word there has the model's inputs");
}

TEST(Test, AReportThatCannotBeWrittenDoesNotCostTheVerdict) {
  const TempDir folder;
  const std::string two = write(folder, "two.dot", every_second);
  const SubprocessResult result =
      run_maide({"test", two, "sim:" + two, "--junit", "/dev/full", "-q"});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.out, StartsWith("Conforms: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("/dev/full"));
}

TEST(Test, ALimitLeavesItUnfinished) {
  const TempDir folder;
  const std::string two = write(folder, "two.dot", every_second);
  const SubprocessResult result =
      run_maide({"test", two, "sim:" + two, "--max-tests", "3", "--json"});
  EXPECT_EQ(result.exit_status, 3);
  const Json json = json_of(result);
  EXPECT_EQ(json.at("verdict"), "not finished");
  EXPECT_EQ(json.at("error"), "stopped at the limit of 3 experiments");
}

}  // namespace
}  // namespace maide::test
