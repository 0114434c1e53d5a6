// Every option and argument of every command has a help text, and no two commands mean different
// things by the same name.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "maide/cli/command.hpp"

namespace maide::test {
namespace {

TEST(OptionHelp, EveryOptionIsDocumented) {
  for (const cli::Command& command : cli::command_table()) {
    EXPECT_FALSE(command.summary.empty()) << command.name;
    EXPECT_TRUE(command.examples.starts_with("maide " + std::string(command.name)));
    cli::CommandLine line("maide", "");
    command.set_up(line);
    for (const cli::Argument& argument : line.all()) {
      EXPECT_FALSE(argument.help().empty()) << command.name << " " << argument.name();
    }
  }
}

TEST(OptionHelp, ShortNamesMeanTheSameEverywhere) {
  std::map<std::string, std::string> meaning;  // short name -> long name
  for (const cli::Command& command : cli::command_table()) {
    cli::CommandLine line("maide", "");
    command.set_up(line);
    for (const cli::Argument& argument : line.all()) {
      if (argument.short_names().empty() || argument.long_names().empty()) continue;
      const std::string long_name = argument.long_names().front();
      const auto known = meaning.emplace(argument.short_names().front(), long_name).first;
      EXPECT_EQ(known->second, long_name) << command.name;
    }
  }
}

}  // namespace
}  // namespace maide::test
