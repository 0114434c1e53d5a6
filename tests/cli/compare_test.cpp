// `maide compare` with the real program.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

std::string model(const std::string& name) {
  return MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot";
}

TEST(Compare, EqualModelsEndWithZero) {
  const SubprocessResult text = run_maide({"compare", model("port"), model("port")});
  EXPECT_EQ(text.exit_status, 0);
  EXPECT_THAT(text.out, HasSubstr("The same: "));
  const Json json = json_of(run_maide(
      {"compare", model("strict-3-tryread"), model("strict-3-tryread-absorb"), "--json"}));
  EXPECT_EQ(json.at("same"), true);
  EXPECT_EQ(json.at("soft"), Json::array());
}

// The second model is learned.
TEST(Compare, ASystemIsLearned) {
  const SubprocessResult same =
      run_maide({"compare", model("strict-2"), "port", "kind=strict", "size=2"});
  EXPECT_EQ(same.exit_status, 0) << same.out << same.err;
  EXPECT_THAT(same.out, testing::StartsWith("The same: "));
  const SubprocessResult other =
      run_maide({"compare", model("strict-2"), "sim:" + model("buffered"), "--json"});
  EXPECT_EQ(other.exit_status, 1) << other.out << other.err;
  const Json json = json_of(other);
  EXPECT_EQ(json.at("same"), false);
  EXPECT_EQ(json.at("learned").at("system"), "sim:" + model("buffered"));
  expect_error(run_maide({"compare", model("port"), model("strict-1"), "size=2"}), 2,
               "'size=2' is an option of a system");
  expect_error(run_maide({"compare", model("port"), "prot"}), 2, "did you mean 'port'?");
}

TEST(Compare, StrictOfOneAndPortDifferInTheMarkAlone) {
  const SubprocessResult text = run_maide({"compare", model("strict-1"), model("port")});
  EXPECT_EQ(text.exit_status, 0);
  EXPECT_EQ(text.out,
            "They do not contradict each other; one knows what the other never tried:\n"
            "  after ?write: ?write is never tried in strict-1.dot, refused in port.dot\n"
            "Note: hidden returns differ: none in the first, write in the second.\n");
  EXPECT_EQ(run_maide({"compare", model("strict-1"), model("port"), "--strict"}).exit_status, 1);
  EXPECT_EQ(run_maide({"compare", model("port"), model("port"), "--strict"}).exit_status, 0);
  const SubprocessResult result =
      run_maide({"compare", model("strict-1"), model("port"), "--json"});
  EXPECT_EQ(result.exit_status, 0);
  const Json json = json_of(result);
  EXPECT_EQ(json.at("differ_in_marks_alone"), true);
  EXPECT_EQ(json.at("hard"), nullptr);
  EXPECT_EQ(json.at("soft"), Json::parse(R"([{"word": ["?write"], "inputs":
      [{"input": "write", "left": "never tried", "right": "refused"}]}])"));
}

TEST(Compare, ContradictionsCarryTheShortestWord) {
  const SubprocessResult text = run_maide({"compare", model("buffered"), model("port")});
  EXPECT_EQ(text.exit_status, 1);
  EXPECT_THAT(text.out, HasSubstr("?write ?write\n"));
  EXPECT_THAT(text.out, HasSubstr("enabled in buffered.dot, which offers ?write, ?read\n"));
  const Json json = json_of(run_maide({"compare", model("buffered"), model("port"), "--json"}));
  EXPECT_EQ(json.at("hard").at("word"), Json::parse(R"(["?write", "?write"])"));
  EXPECT_EQ(json.at("hard").at("right_offers"), Json::parse(R"(["?read"])"));
}

// All differences: the first in full, a line for each other one, and no more than twenty.
TEST(Compare, AllDifferencesAreListed) {
  const TempDir folder;
  const auto ring = [&](const std::string& name, const std::string& output) {
    std::string text = "digraph {";
    for (int i = 0; i < 26; ++i) {
      const int next = (i + 1) % 26;
      text +=
          fmt::format("s{0} -> s{1} [label=\"go / ok\"]; s{0} -> s{0} [label=\"look / {2}{0}\"];",
                      i, next, i % 26 == 0 ? "at " : output);
    }
    const std::string file = (folder.path() / name).string();
    write_file_atomically(file, text + "}");
    return file;
  };
  const std::string one = ring("one.dot", "at "), two = ring("two.dot", "near ");
  const SubprocessResult text = run_maide({"compare", one, two});
  EXPECT_EQ(text.exit_status, 1);
  EXPECT_THAT(text.out, testing::StartsWith(
                            "They differ: a shortest word of 2 inputs tells them apart\n"
                            "  go look\n  one.dot answers at 1\n  two.dot answers near 1\n"
                            "Besides, 24 differences:\n"
                            "  after go go: look gives at 2 in one.dot, near 2 in two.dot\n"));
  EXPECT_THAT(text.out, testing::EndsWith("\n  and 4 more; --json lists all\n"));
  const Json json = json_of(run_maide({"compare", one, two, "--json"}));
  EXPECT_EQ(json.at("differences").size(), 25U);
  EXPECT_EQ(json.at("differences")[1],
            Json::parse(R"({"word": ["go", "go"], "question": "look", "left": "at 2",
                            "right": "near 2", "bound": false, "passed": 0})"));
  EXPECT_EQ(json.at("differences_complete"), true);
}

TEST(Compare, MealyMachines) {
  const TempDir folder;
  const std::string one = (folder.path() / "one.dot").string();
  const std::string two = (folder.path() / "two.dot").string();
  write_file_atomically(one, "digraph { a -> b [label=\"x / 0\"]; b -> a [label=\"x / 0\"] }");
  write_file_atomically(two, "digraph { a -> b [label=\"x / 0\"]; b -> a [label=\"x / 1\"] }");
  EXPECT_EQ(run_maide({"compare", one, one}).exit_status, 0);
  const SubprocessResult text = run_maide({"compare", one, two});
  EXPECT_EQ(text.exit_status, 1);
  EXPECT_EQ(text.out,
            "They differ: a shortest word of 2 inputs tells them apart\n  x x\n  one.dot answers "
            "0\n  two.dot answers 1\n");
  const Json json = json_of(run_maide({"compare", one, two, "--json"}));
  EXPECT_EQ(json.at("word"), Json::parse(R"(["x", "x"])"));
  EXPECT_EQ(json.at("right"), "1");
}

// A Mealy machine stands for an interface automaton: a port without a buffer, learned eagerly.
TEST(Compare, AMealyMachineWithAnAutomaton) {
  const TempDir folder;
  const std::string file = (folder.path() / "mealy.dot").string();
  write_file_atomically(file, R"(digraph {
    idle -> written [label="write / quiet"]; idle -> reading [label="read / quiet"];
    written -> written [label="write / refused"]; written -> idle [label="read / message"];
    reading -> idle [label="write / message"]; reading -> reading [label="read / refused"]; })");
  const SubprocessResult result = run_maide({"compare", file, model("port")});
  EXPECT_EQ(result.exit_status, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("Note: mealy.dot is a Mealy machine and is compared as"));
}

TEST(Compare, WhatCannotBeReadIsAnError) {
  expect_error(run_maide({"compare", model("port"), "nothing.dot"}), 2, "(nothing.dot)");
  expect_error(run_maide({"compare", model("port")}), 2, "B");
  const TempDir folder;
  const std::string file = (folder.path() / "broken.dot").string();
  write_file_atomically(file, "digraph {\n  a -> }");
  expect_error(run_maide({"compare", file, file}), 2, "broken.dot:2:8)");
}

}  // namespace
}  // namespace maide::test
