// What all commands share: overview, help, version, misspelt names, broken outputs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/command.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/learner.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

TEST(CommandLine, AloneItGivesAnOverview) {
  const SubprocessResult result = run_maide({});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.err, "");
  for (const cli::Command& command : cli::command_table()) {
    EXPECT_THAT(result.out, HasSubstr("\n  " + std::string(command.name) + " "));
  }
  EXPECT_EQ(run_maide({"--help"}).out, result.out);
  EXPECT_EQ(run_maide({"help"}).out, result.out);
}

TEST(CommandLine, SaysItsVersion) {
  EXPECT_EQ(run_maide({"--version"}).out, "maide " + std::string(version()) + "\n");
}

// A page of a terminal holds it; `-v` tells all.
TEST(CommandLine, HelpFitsATerminal) {
  const auto expect_narrow = [](const std::string& text) {
    for (const std::string_view line : split_lines(text)) EXPECT_LE(line.size(), 80) << line;
  };
  std::vector<std::vector<std::string>> calls{{"--help"}};
  for (const cli::Command& command : cli::command_table()) {
    calls.push_back({std::string(command.name), "--help"});
  }
  for (const std::vector<std::string>& call : calls) {
    const std::string text = run_maide(call).out;
    EXPECT_LE(split_lines(text).size(), 50) << call.front();
    expect_narrow(text);
  }
  const std::string all = run_maide({"learn", "--help", "-v"}).out;
  EXPECT_GT(split_lines(all).size(), 50);
  EXPECT_THAT(all, HasSubstr("transducer of Aarts and"));
  expect_narrow(all);
  for (const cli::HelpPage& page : cli::help_pages()) {
    const SubprocessResult result = run_maide({"help", std::string(page.name)});
    EXPECT_EQ(result.exit_status, 0) << result.err;
    EXPECT_GT(split_lines(result.out).size(), 10) << page.name;
    expect_narrow(result.out);
  }
}

// The pages are made from the tables.
TEST(CommandLine, PagesNameEverything) {
  const std::string algorithms = run_maide({"help", "algorithms"}).out;
  for (const LearnerEntry& entry : learners()) {
    EXPECT_THAT(algorithms, HasSubstr("\n  " + std::string(entry.name) + " "));
  }
  const std::string tests = run_maide({"help", "tests"}).out;
  for (const TestMethodEntry& entry : test_methods()) {
    EXPECT_THAT(tests, HasSubstr("\n  " + std::string(entry.name) + " "));
  }
  for (const TestOption& option : test_options()) {
    EXPECT_THAT(tests, HasSubstr("\n  --" + std::string(option.key) + " "));
  }
  EXPECT_THAT(run_maide({"learn", "--help"}).out, HasSubstr("--infix-mean"));
}

TEST(CommandLine, ColoursAreForTerminals) {
  const std::vector<std::string> call{"check",
                                      MAIDE_SOURCE_DIR "/examples/case-study-1/buffered.yaml"};
  const auto with = [&](const std::string& mode) {
    std::vector<std::string> arguments = call;
    arguments.insert(arguments.end(), {"--color", mode});
    return run_maide(arguments).out;
  };
  EXPECT_THAT(run_maide(call).out, testing::StartsWith("verdict: violated"));
  EXPECT_EQ(with("auto").find('\033'), std::string::npos);
  EXPECT_THAT(with("always"), testing::StartsWith("\033[31mverdict: violated"));
  EXPECT_EQ(with("never").find('\033'), std::string::npos);
  const std::string on_terminal = "script -qec \"$maide nothing\" /dev/null </dev/null | cat -v";
  EXPECT_THAT(run_with_maide("export TERM=xterm; unset NO_COLOR; export maide; " + on_terminal).out,
              HasSubstr("^[[31mmaide:^[[0m unknown command"));
  EXPECT_THAT(run_with_maide("export TERM=xterm NO_COLOR=1; export maide; " + on_terminal).out,
              testing::StartsWith("maide: unknown command"));
}

TEST(CommandLine, EveryCommandHasHelpWithAnExample) {
  for (const cli::Command& command : cli::command_table()) {
    const std::string name(command.name);
    const SubprocessResult result = run_maide({name, "--help"});
    EXPECT_EQ(result.exit_status, 0) << name;
    EXPECT_EQ(result.err, "") << name;
    EXPECT_THAT(result.out, HasSubstr("Usage: maide " + name));
    EXPECT_THAT(result.out, HasSubstr("Example:\n  maide " + name));
    EXPECT_THAT(result.out, HasSubstr("--json"));
    EXPECT_EQ(run_maide({"help", name}).out, result.out);
    EXPECT_EQ(run_maide({name, "-h"}).out, result.out);
  }
}

// Each construct of the grammar in check/language/program_tree.hpp, on a page for a terminal.
TEST(CommandLine, ShowsTheLanguageOfSystemFiles) {
  const SubprocessResult result = run_maide({"help", "language"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.err, "");
  for (const char* const word : {"constants:",
                                 "topics:",
                                 "ends:",
                                 "models:",
                                 "variables:",
                                 "procedures:",
                                 "programs:",
                                 "properties:",
                                 "use: mutex",
                                 "use: semaphore",
                                 "use: queue",
                                 "may_die",
                                 "when_unexplored",
                                 "when_weak",
                                 "idle ",
                                 "switch ",
                                 "quiet ",
                                 "wait M",
                                 "select ",
                                 "on M.input",
                                 "on M!output",
                                 "when (e)",
                                 "otherwise ",
                                 "timeout ",
                                 "if *",
                                 "if fair *",
                                 "if (e)",
                                 "else if (e)",
                                 "loop ",
                                 "while (e)",
                                 "repeat e",
                                 "for k in",
                                 "break;",
                                 "continue;",
                                 "stop;",
                                 "skip;",
                                 "var x",
                                 "any e..e",
                                 "any fair",
                                 "atomic ",
                                 "call p(",
                                 "return;",
                                 "@name",
                                 "forall ",
                                 "P:M.input",
                                 "services:",
                                 "executors:",
                                 "nodes:",
                                 "order: any|rounds",
                                 "threads: n",
                                 "takes: M.read",
                                 "timer: MS",
                                 "serves: S",
                                 "S.send",
                                 "S.serve -> request;",
                                 "S.answer;",
                                 "N.callback@label"}) {
    EXPECT_THAT(result.out, HasSubstr(word));
  }
  const std::vector<std::string_view> lines = split_lines(result.out);
  EXPECT_LE(lines.size(), 50);
  for (const std::string_view line : lines) EXPECT_LE(line.size(), 80) << line;
  expect_error(run_maide({"language"}), 2, "unknown command 'language'");
}

TEST(CommandLine, SuggestsCommandsAndOptions) {
  expect_error(run_maide({"doctr"}), 2, "unknown command 'doctr'; did you mean 'doctor'?");
  expect_error(run_maide({"doctor", "--jsn"}), 2, "unknown option '--jsn'; did you mean '--json'?");
  expect_error(run_maide({"doctor", "--jsn=1"}), 2, "unknown option '--jsn'");
  expect_error(run_maide({"doctor", "-x"}), 2, "unknown option '-x'");
  // Only where systems have options.
  expect_error(run_maide({"learn", "port", "--depth", "3"}), 2,
               "unknown option '--depth'; an option of the system is written depth=3 (see");
  expect_error(run_maide({"learn", "port", "--depth=3"}), 2, "is written depth=3 (see");
  expect_error(run_maide({"learn", "port", "--depth"}), 2, "is written depth=VALUE (see");
  expect_error(run_maide({"--verbose"}), 2, "unknown option '--verbose'");
  expect_error(run_maide({""}), 2, "unknown command ''");
  expect_error(run_maide({"learn", "port", "--algorithm", ""}), 2,
               "the value of --algorithm is empty");
  expect_error(run_maide({"learn", "port", "--eq", ""}), 2, "the value of --eq is empty");
  expect_error(run_maide({"learn", "port", "--algorithm", "magic"}), 2,
               "'magic' is none of lsharp, ");
  expect_error(run_maide({"help", "nothing"}), 2, "unknown command 'nothing'");
}

TEST(CommandLine, RefusesWhatItDoesNotExpect) {
  expect_error(run_maide({"doctor", "ros2", "a.yaml", "x"}), 2,
               "unexpected argument 'x' (see 'maide doctor --help')");
  expect_error(run_maide({"doctor", "-q", "-v"}), 2, "-q and -v exclude each other");
  expect_error(run_maide({"doctor", "a\nb"}), 2, "a b");
  expect_error(run_maide({std::string(100000, 'x')}), 2, "unknown command");
}

TEST(CommandLine, ErrorsAreJsonToo) {
  const SubprocessResult result = run_maide({"doctor", "--json", "x"});
  EXPECT_EQ(result.exit_status, 2);
  const Json object = json_of(result);
  EXPECT_EQ(object.at("status"), 2);
  EXPECT_EQ("maide: " + object.at("error").get<std::string>() + "\n", result.err);
}

TEST(CommandLine, AResultThatCannotBeWrittenIsAnError) {
  expect_error(run_with_maide("\"$maide\" doctor >/dev/full"), 3,
               "cannot write the result: No space left on device (standard output)");
  expect_error(run_with_maide("\"$maide\" doctor >&-"), 2, "(standard output)");
  expect_error(run_with_maide("\"$maide\" doctor --json >/dev/full"), 3, "(standard output)");
  expect_error(run_with_maide("\"$maide\" --help >&-"), 2, "(standard output)");
}

TEST(CommandLine, ABrokenPipeIsAnError) {
  // The reader is gone before the writer starts.
  const SubprocessResult result = run_with_maide(
      "d=$(mktemp -d); mkfifo \"$d/p\"; (: <\"$d/p\") & exec 3>\"$d/p\"; wait; "
      "\"$maide\" doctor >&3; s=$?; rm -r \"$d\"; exit $s");
  expect_error(result, 2, "Broken pipe");
}

TEST(CommandLine, WorksWithoutInputAndErrorStream) {
  EXPECT_EQ(run_with_maide("\"$maide\" --version <&- 2>&-").exit_status, 0);
  EXPECT_EQ(run_with_maide("\"$maide\" nothing 2>&-").exit_status, 2);
  EXPECT_EQ(run_with_maide("\"$maide\" nothing 2>/dev/full").exit_status, 2);
}

TEST(CommandLine, DoesNotDependOnTheLocale) {
  EXPECT_EQ(run_with_maide("LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 \"$maide\" help doctor").out,
            run_maide({"doctor", "--help"}).out);
}

// Programs that read --json see whether they know its members.
TEST(CommandLine, EveryJsonResultNamesItsSchema) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"doctor", "--json"},
        {"compare", "--json", "no-such-model.dot", "b"}}) {
    const SubprocessResult result = run_maide(arguments);
    EXPECT_EQ(parse_json(result.out, "result").at("schema"), 1) << result.out;
  }
}

}  // namespace
}  // namespace maide::test
