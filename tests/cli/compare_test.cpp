// `maide compare` with the real program.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "maide/automata/random_automata.hpp"
#include "maide/base/file.hpp"
#include "maide/formats/model_file.hpp"
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
                            "  after go twice: look gives at 2 in one.dot, near 2 in two.dot\n"));
  EXPECT_THAT(text.out, testing::EndsWith("\n  and 4 more; --json lists all, --html shows them\n"));
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

// The page is played with Node: what its script marks, row by row, as the models say.
TEST(Compare, APageIsSteppedThrough) {
  if (!can_step_through()) GTEST_SKIP() << "needs node (Debian: nodejs)";
  const TempDir folder;
  const std::string page = (folder.path() / "page.html").string();
  const SubprocessResult compared =
      run_maide({"compare", model("buffered"), model("strict-2"), "--html", page, "--json"});
  EXPECT_EQ(compared.exit_status, 1) << compared.err;
  EXPECT_EQ(json_of(compared).at("html"), page);
  // To the end, one back, beyond the end, by a button, by a click on a row.
  const std::string played =
      step_through(page, "ArrowRight,ArrowRight,ArrowLeft,End,ArrowRight,Home,n,#next,#w0s4");
  EXPECT_EQ(
      played,
      R"(start: difference 1 of 1, step 0 of 6 | 0 ; (start) ;  ;  ; empty ; empty | A at empty, B at empty
ArrowRight: difference 1 of 1, step 1 of 6 | 1 ; ?write ; taken ; taken ; holds 1 ; holds 1 | A at holds 1, B at holds 1
ArrowRight: difference 1 of 1, step 2 of 6 | 2 ; ?write ; taken ; taken ; holds 1 ; holds 2 | A at holds 1, B at B: holds 2 never tried: ?write
ArrowLeft: difference 1 of 1, step 1 of 6 | 1 ; ?write ; taken ; taken ; holds 1 ; holds 1 | A at holds 1, B at holds 1
End: difference 1 of 1, step 6 of 6 | 6 ; what comes out ; nothing ; message ; empty, reader waits ; empty | A at empty, reader waits, B at empty
ArrowRight: difference 1 of 1, step 6 of 6 | 6 ; what comes out ; nothing ; message ; empty, reader waits ; empty | A at empty, reader waits, B at empty
Home: difference 1 of 1, step 0 of 6 | 0 ; (start) ;  ;  ; empty ; empty | A at empty, B at empty
n: difference 1 of 1, step 0 of 6 | 0 ; (start) ;  ;  ; empty ; empty | A at empty, B at empty
#next: difference 1 of 1, step 1 of 6 | 1 ; ?write ; taken ; taken ; holds 1 ; holds 1 | A at holds 1, B at holds 1
#w0s4: difference 1 of 1, step 4 of 6 | 4 ; what comes out ; message ; message ; empty ; holds 1 | A at empty, B at holds 1
)");
}

// Names that mean something in HTML, several differences, and one that is behind another.
TEST(Compare, APageHasEveryDifference) {
  if (!can_step_through()) GTEST_SKIP() << "needs node (Debian: nodejs)";
  const TempDir folder;
  const std::string one = (folder.path() / "<one>.dot").string();
  const std::string two = (folder.path() / "two.dot").string();
  const std::string page = (folder.path() / "page.html").string();
  write_file_atomically(one, R"(digraph { a -> b [label="x / <0>"]; a -> a [label="y / &"];
                                          b -> a [label="x / 0"]; b -> b [label="y / end"]; })");
  write_file_atomically(two, R"(digraph { a -> b [label="x / </script>"]; a -> a [label="y / &"];
                                          b -> a [label="x / 0"]; b -> b [label="y / no end"]; })");
  EXPECT_EQ(run_maide({"compare", one, two, "--html", page}).exit_status, 1);
  EXPECT_EQ(
      step_through(page, "ArrowRight,n,End,p"),
      R"(start: difference 1 of 2, step 0 of 1 | 0 ; (start) ;  ;  ; at the start ; at the start | A at at the start, B at at the start
ArrowRight: difference 1 of 2, step 1 of 1 | 1 ; x ; <0> ; </script> ; after x ; after x | A at after x, B at after x
n: difference 2 of 2, step 0 of 2 | 0 ; (start) ;  ;  ; at the start ; at the start | A at at the start, B at at the start
End: difference 2 of 2, step 2 of 2 | 2 ; y ; end ; no end ; after x ; after x | A at after x, B at after x
p: difference 1 of 2, step 0 of 1 | 0 ; (start) ;  ;  ; at the start ; at the start | A at at the start, B at at the start
)");
  EXPECT_THAT(step_through(page + "#2.1", ""),
              testing::StartsWith("start: difference 2 of 2, step 1 "));
  EXPECT_THAT(step_through(page + "#2.3", ""),
              testing::StartsWith("start: difference 1 of 2, step 0 "));
  const std::string text = read_file(page);
  EXPECT_THAT(text, HasSubstr("<h1>&lt;one&gt;.dot and two.dot</h1>"));
  EXPECT_THAT(text, HasSubstr("They differ: 2 independent differences."));
}

// Models that are the same have a page, too, without anything to step through.
TEST(Compare, APageOfEqualModels) {
  const TempDir folder;
  const std::string page = (folder.path() / "page.html").string();
  for (const char* const name : {"strict-2", "port"}) {
    EXPECT_EQ(run_maide({"compare", model(name), model(name), "--html", page}).exit_status, 0);
    const std::string text = read_file(page);
    EXPECT_THAT(text, HasSubstr("They are the same."));
    EXPECT_THAT(text, HasSubstr("class=\"node both\""));
    EXPECT_THAT(text, testing::Not(HasSubstr("class=\"node left\"")));
    EXPECT_THAT(text, HasSubstr("id=\"walks\">[]</script>"));
  }
}

// 300 states: the words and what is around them are drawn.
TEST(Compare, APageOfLargeModelsIsCut) {
  if (!can_step_through()) GTEST_SKIP() << "needs node (Debian: nodejs)";
  const TempDir folder;
  const std::string page = (folder.path() / "page.html").string();
  Random random(7);
  const Mealy left = random_mealy({300, 4, 4}, random);
  const auto write = [&](const std::string& name, const Mealy& machine) {
    std::ostringstream text;
    write_dot(text, machine);
    const std::string file = (folder.path() / name).string();
    write_file_atomically(file, text.str());
    return file;
  };
  const std::string one = write("one.dot", left), two = write("two.dot", mutate(left, 3, random));
  const SubprocessResult compared = run_maide({"compare", one, two, "--html", page, "--json"});
  EXPECT_EQ(compared.exit_status, 1);
  const std::size_t count = json_of(compared).at("differences").size();
  EXPECT_GE(count, 1U);
  EXPECT_LE(count, 6U);
  EXPECT_THAT(read_file(page), HasSubstr(" states are drawn: those on the words below"));
  EXPECT_THAT(step_through(page, "End"),
              HasSubstr(fmt::format("\nEnd: difference 1 of {},", count)));
}

TEST(Compare, APageIsRefusedBeforeAnythingIsCompared) {
  expect_error(run_maide({"compare", model("port"), model("strict-1"), "--html", model("port")}), 2,
               "--html would write over a file that is used");
  expect_error(run_maide({"compare", model("port"), model("strict-1"), "--html", "/no/page.html"}),
               2, "/no/page.html");
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
