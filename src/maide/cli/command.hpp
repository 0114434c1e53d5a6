// The frame of the command line. A command is a row of the table in command_table.cpp and a
// function that declares its options; everything that commands share (help, --json, -v, -q, errors,
// exit statuses, Ctrl-C) is done once, in run_command_line.cpp.
//
// A command's file looks like this:
//
//   struct CompareArguments { std::string a, b; };
//
//   RunFunction set_up_compare(CLI::App& app) {
//     auto arguments = std::make_shared<CompareArguments>();
//     app.add_option("A", arguments->a, "A model file")->required();
//     app.add_option("B", arguments->b, "Another model file")->required();
//     return [arguments](Context& context) { return compare(*arguments, context); };
//   }
//
// The run function prints its result with context.print() and context.set_result(), lets
// maide::Error pass, and returns the exit status.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "maide/base/error.hpp"
#include "maide/cli/context.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace maide::cli {

// Does a command's work once its arguments are parsed.
using RunFunction = std::function<ExitStatus(Context& context)>;

struct Command {
  std::string_view name;
  std::string_view summary;   // one line, for the overview and the command's own help
  std::string_view examples;  // command lines, one a line, for the end of the help
  // Declares options and arguments; each must have a help text.
  RunFunction (*set_up)(CLI::App& app);
};

// Every command of this version, in the order of the overview.
std::span<const Command> command_table();

// One function for each row of the table, in a file of its own.
RunFunction set_up_bench(CLI::App& app);
RunFunction set_up_cache(CLI::App& app);
RunFunction set_up_compare(CLI::App& app);
RunFunction set_up_doctor(CLI::App& app);
RunFunction set_up_check(CLI::App& app);
RunFunction set_up_export(CLI::App& app);
RunFunction set_up_learn(CLI::App& app);
RunFunction set_up_replay(CLI::App& app);
RunFunction set_up_reproduce(CLI::App& app);
RunFunction set_up_view(CLI::App& app);

// The options that several commands have, so that they read the same everywhere.
CLI::Option* add_seed_option(CLI::App& app, std::uint64_t& seed);
// 0: not given, the default of each system.
CLI::Option* add_jobs_option(CLI::App& app, std::size_t& jobs);

// Parses the command line and runs the command; never throws. Returns the exit status.
int run_command_line(int argc, const char* const* argv) noexcept;

}  // namespace maide::cli
