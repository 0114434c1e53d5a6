// `maide completion` and `maide manual`: every option of every command is there, and shells and
// groff take what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

bool has_program(const std::string& name) {
  return run_program({"sh", "-c", "command -v " + name}).exit_status == 0;
}

// "--output" and the like, of the command's row in the option table.
std::vector<std::string> options_of(const cli::Command& command) {
  const cli::DeclaredCommand declared(command);
  std::vector<std::string> names;
  for (const cli::Argument& argument : declared.line.all()) {
    for (const std::string& name : argument.long_names()) names.push_back("--" + name);
  }
  return names;
}

class Completion : public testing::Test {
 protected:
  std::string script(const std::string& shell) {
    const std::string path = (folder_.path() / ("maide." + shell)).string();
    const SubprocessResult written = run_maide({"completion", shell});
    EXPECT_EQ(written.exit_status, 0) << written.err;
    write_file_atomically(path, written.out);
    return path;
  }
  // What bash offers for the last of the words.
  std::set<std::string> bash_offers(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += " " + quote_shell_word(word);
    const SubprocessResult result =
        run_program({"bash", "-c",
                     "set -eu; . '" + script("bash") + "'; COMP_WORDS=(" + line +
                         "); COMP_CWORD=" + std::to_string(words.size() - 1) +
                         "; _maide || true; printf '%s\\n' " + "\"${COMPREPLY[@]}\""});
    EXPECT_EQ(result.err, "");
    std::istringstream out(result.out);
    std::set<std::string> offers;
    for (std::string word; out >> word;) offers.insert(word);
    return offers;
  }
  TempDir folder_{"maide-test-"};
};

TEST_F(Completion, BashOffersCommandsOptionsAndValues) {
  EXPECT_THAT(bash_offers({"maide", ""}), IsSupersetOf({"learn", "check", "help", "--version"}));
  EXPECT_EQ(bash_offers({"maide", "le"}), std::set<std::string>{"learn"});
  EXPECT_EQ(bash_offers({"maide", "check", "--eng"}), std::set<std::string>{"--engine"});
  EXPECT_EQ(bash_offers({"maide", "check", "--engine", ""}),
            (std::set<std::string>{"native", "spin", "ltsmin"}));
  EXPECT_EQ(bash_offers({"maide", "check", "--engine", "s"}), std::set<std::string>{"spin"});
  EXPECT_THAT(bash_offers({"maide", "learn", ""}), Contains("cyclonedds"));
  EXPECT_THAT(bash_offers({"maide", "learn", "-o", ""}), IsEmpty());  // files
  EXPECT_THAT(bash_offers({"maide", "help", "la"}), Contains("language"));
}

TEST_F(Completion, BashOffersEveryOption) {
  for (const cli::Command& command : cli::command_table()) {
    EXPECT_THAT(bash_offers({"maide", std::string(command.name), "--"}),
                IsSupersetOf(options_of(command)))
        << command.name;
  }
}

TEST_F(Completion, FishOffersOptionsAndValues) {
  if (!has_program("fish")) GTEST_SKIP() << "skipped: no fish";
  const std::string path = script("fish");
  const auto offers = [&](const std::string& line) {
    const SubprocessResult result = run_program(
        {"fish", "--no-config", "-c", "source " + path + "; complete -C '" + line + "'"});
    EXPECT_EQ(result.err, "");
    return result.out;
  };
  EXPECT_THAT(offers("maide le"), HasSubstr("learn\tLearn a model"));
  EXPECT_THAT(offers("maide check --engine "), HasSubstr("ltsmin"));
  for (const cli::Command& command : cli::command_table()) {
    const std::string given = offers("maide " + std::string(command.name) + " --");
    for (const std::string& option : options_of(command)) EXPECT_THAT(given, HasSubstr(option));
  }
}

// _arguments says what is wrong with what it is given only when it runs. So a shell on a terminal
// of its own completes real lines. Keys that come before its prompt are not edited.
TEST_F(Completion, ZshOffersOptionsAndValues) {
  if (!has_program("zsh")) GTEST_SKIP() << "skipped: no zsh";
  const std::string start =
      "PS1='PRO''MPT '; TERM=dumb; autoload -U compinit; compinit -u -D; source " + script("zsh") +
      "; LISTMAX=1000; bindkey '^I' list-choices";
  std::vector<std::string> lines{"maide che", "maide check --engine "};
  for (const cli::Command& command : cli::command_table()) {
    lines.push_back("maide " + std::string(command.name) + " --");
  }
  std::string keys;
  for (const std::string& line : lines) {
    keys += "; zpty -w -n z $'" + line + "\\t'; zpty -w z $'\\C-u'\"print fin''ished\"; " +
            "zpty -r z seen '*finished*PROMPT *'; print -r -- $seen; print END";
  }
  const SubprocessResult result =
      run_program({"zsh", "-f", "-c",
                   "zmodload zsh/zpty; zpty z zsh -f -i; zpty -w z " + quote_shell_word(start) +
                       "; zpty -r z seen '*PROMPT *'" + keys + "; zpty -d z"});
  EXPECT_EQ(result.err, "");
  std::vector<std::string> offers(1);
  for (const std::string_view line : split_lines(result.out)) {
    if (line == "END") {
      offers.emplace_back();
    } else {
      offers.back() += std::string(line) + "\n";
    }
  }
  ASSERT_EQ(offers.size(), lines.size() + 1);
  EXPECT_THAT(offers[0], HasSubstr("check"));
  EXPECT_THAT(offers[1], HasSubstr("native"));
  EXPECT_THAT(offers[1], HasSubstr("ltsmin"));
  std::size_t place = 2;
  for (const cli::Command& command : cli::command_table()) {
    EXPECT_THAT(offers[place], Not(HasSubstr("invalid"))) << command.name;
    for (const std::string& option : options_of(command)) {
      EXPECT_THAT(offers[place], HasSubstr(option)) << command.name;
    }
    ++place;
  }
}

TEST(Manual, PagesHaveEveryOptionAndAreSound) {
  const TempDir folder("maide-test-");
  const SubprocessResult written = run_maide({"manual", "--all", "-o", folder.path().string()});
  EXPECT_EQ(written.exit_status, 0) << written.err;
  const bool has_groff = has_program("groff");
  for (const cli::Command& command : cli::command_table()) {
    const std::string path =
        (folder.path() / ("maide-" + std::string(command.name) + ".1")).string();
    EXPECT_EQ(read_file(path), run_maide({"manual", std::string(command.name)}).out);
    if (!has_groff) continue;
    const SubprocessResult page =
        run_program({"groff", "-man", "-Tascii", "-P-c", "-P-b", "-P-u", "-ww", path});
    EXPECT_EQ(page.err, "") << path;
    for (const std::string& option : options_of(command)) EXPECT_THAT(page.out, HasSubstr(option));
    for (const std::string_view example : split_lines(command.examples)) {
      EXPECT_THAT(page.out, HasSubstr(std::string(example)));
    }
  }
  EXPECT_THAT(read_file(folder.path() / "maide.1"), HasSubstr("maide\\-completion (1)"));
  if (!has_groff) GTEST_SKIP() << "skipped: no groff";
}

TEST(Manual, RefusesWhatDoesNotGoTogether) {
  expect_error(run_maide({"manual", "chekc"}), 2, "did you mean 'check'?");
  expect_error(run_maide({"manual", "--all"}), 2, "--all and -o FOLDER go together");
  expect_error(run_maide({"manual", "check", "--all", "-o", "."}), 2, "the pages of all commands");
  expect_error(run_maide({"manual", "--all", "-o", "/does/not/exist"}), 2, "/does/not/exist");
  expect_error(run_maide({"completion", "csh"}), 2, "'csh' is none of bash, zsh, fish");
}

}  // namespace
}  // namespace maide::test
