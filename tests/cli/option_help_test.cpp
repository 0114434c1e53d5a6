// Every option and argument of every command has a help text, and no two commands mean different
// things by the same name.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "maide/cli/command.hpp"

namespace maide::test {
namespace {

TEST(OptionHelp, EveryOptionIsDocumented) {
  for (const cli::Command& command : cli::command_table()) {
    EXPECT_FALSE(command.summary.empty()) << command.name;
    EXPECT_TRUE(command.examples.starts_with("maide " + std::string(command.name)));
    CLI::App app;
    command.set_up(app);
    for (const CLI::Option* option : app.get_options()) {
      EXPECT_FALSE(option->get_description().empty())
          << command.name << " " << option->get_name(true, true);
    }
  }
}

TEST(OptionHelp, ShortNamesMeanTheSameEverywhere) {
  std::map<std::string, std::string> meaning;  // short name -> long name
  for (const cli::Command& command : cli::command_table()) {
    CLI::App app;
    command.set_up(app);
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_snames().empty() || option->get_lnames().empty()) continue;
      const std::string& long_name = option->get_lnames().front();
      const auto known = meaning.emplace(option->get_snames().front(), long_name).first;
      EXPECT_EQ(known->second, long_name) << command.name;
    }
  }
}

}  // namespace
}  // namespace maide::test
