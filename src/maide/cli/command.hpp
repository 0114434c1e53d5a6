// The frame of the command line. A command is a row of the table in command.cpp, and a function
// that declares its options. Help, --json, -v, -q, errors, exit statuses and Ctrl-C are done once
// for all commands, in run_command_line.cpp.
//
// A command's file looks like this:
//
//   struct CompareArguments { std::string a, b; };
//
//   RunFunction set_up_compare(CommandLine& line) {
//     auto arguments = std::make_shared<CompareArguments>();
//     line.add("A", arguments->a, "A model file").required();
//     line.add("B", arguments->b, "Another model file").required();
//     return [arguments](Context& context) { return compare(*arguments, context); };
//   }
//
// The run function prints its result with context.print() and context.set_result(), lets
// maide::Error pass, and returns the exit status.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/log.hpp"
#include "maide/base/run_control.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/terminal.hpp"

namespace maide {
struct SystemAccess;
}

namespace maide::cli {

// Of the option --initial.
inline constexpr const char* initial_help =
    "The state in which a model begins, by its name in the file, where the file does not mark it";

// In every result of --json: which members there are, and what they mean. A new member does not
// change it.
inline constexpr int json_schema = 1;

// Options of every command.
struct CommonOptions {
  bool json = false;     // --json
  bool quiet = false;    // -q
  bool verbose = false;  // -v
  // The command runs within another program: nothing is printed, and who called it asks for the
  // result (Context::take_result()).
  bool embedded = false;
  ProgressObserver* progress = nullptr;  // of an embedded command; null: nobody is told
};

// What a command works with: the options that every command has, the stop token and the progress
// line for long work, and two ways to give a result, text for people or one JSON object.
class Context {
 public:
  Context(const CommonOptions& options, std::stop_token stop);

  bool json() const noexcept { return options_.json; }
  bool quiet() const noexcept { return options_.quiet; }
  bool verbose() const noexcept { return options_.verbose; }
  bool embedded() const noexcept { return options_.embedded; }

  // For long calls: Ctrl-C, the progress line, no deadline. Valid as long as the context is.
  RunControl control();

  // Result text for people, on standard output at once; nothing under --json. Throws UsageError if
  // standard output cannot be written to, Error (inconclusive) if the disk is full.
  void print(std::string_view text) { print(text, Tone::plain); }
  // Result text for people in a colour, where there are any. On a terminal long lines are broken.
  void print(std::string_view text, Tone tone);
  // Result text that programs read (a model): as it is, but on a terminal.
  void print_data(std::string_view text);

  // The result for programs, printed when the command ends, and only under --json. Once a command.
  void set_result(const Json& object);

  // An error or a remark that ends nothing by itself: one line "maide: message" on standard error,
  // and below it the excerpt of the text in which it is, if there is one.
  void complain(std::string_view message, std::string_view excerpt = {});

  // An error that ends a command which has a result all the same: complain(), and `error` and
  // `status` in the result. Returns the status. Of several the result has the last.
  ExitStatus fail(const std::string& message, ExitStatus status, std::string_view excerpt = {});

  // Prints what set_result left and makes sure that all output has arrived. The result of a command
  // that Ctrl-C ended has `error` and `status`, too.
  void finish(ExitStatus status);
  // Another process prints the result.
  void leave_result_to_another() { has_no_result_ = true; }

  // For an embedded command: the JSON object that finish() would print.
  std::string take_result(ExitStatus status);

 private:
  CommonOptions options_;
  std::stop_token stop_;
  ProgressLine progress_;
  std::optional<std::string> result_;  // the JSON line
  bool has_no_result_ = false;
  std::string failure_;  // of fail()
};

// Writes to standard output and flushes it. Throws as Context::print.
void write_to_stdout(std::string_view text);

// Writes to standard output and flushes it; control characters do not reach a terminal.
void write_data(std::string_view text);

// For a file that an option names and that is written in the end: throws UsageError now where it
// cannot be written, or is one of the files that are `used`. Nothing for an empty path.
void check_output(std::string_view option, const std::string& path,
                  std::initializer_list<std::string> used);

// One error line "maide: message" on standard error; a progress line gives way to it and line
// breaks in the message become spaces.
void write_error_line(std::string_view message);

// Does a command's work once its arguments are parsed.
using RunFunction = std::function<ExitStatus(Context& context)>;

struct Command {
  std::string_view name;
  std::string_view summary;   // one line, for the overview and the command's own help
  std::string_view examples;  // command lines, one a line, for the end of the help
  // Declares options and arguments; each must have a help text.
  RunFunction (*set_up)(CommandLine& line);
};

// The format of `maide export` that the exporters of formats/ do not have, for it needs Graphviz:
// the picture of a model.
inline constexpr std::string_view tikz = "tikz";
inline constexpr std::string_view tikz_summary = "a picture for LaTeX, laid out by Graphviz";

// What `maide help PAGE` prints, for what fits no command's help.
struct HelpPage {
  std::string_view name;
  std::string_view summary;  // one line, for the overview
  std::string (*text)(std::size_t width);
};
std::span<const HelpPage> help_pages();
// Null if there is none of that name.
const HelpPage* find_help_page(std::string_view name);
// A line for each.
std::string describe_help_pages();
// The page on the language of system files.
std::string_view language_help();

// Every command of this version, in the order of the overview.
std::span<const Command> command_table();

// A command with all that it takes, the options of every command, too.
struct DeclaredCommand {
  explicit DeclaredCommand(const Command& command);
  CommandLine line;
  RunFunction run;
  CommonOptions common;
  std::string color = "auto";  // --color
};

// What exit statuses mean, for every command's help and manual page.
std::string_view describe_exit_statuses();

// One function for each row of the table, in a file of its own (new and init share one, as do
// completion and manual, and bench and reproduce: tool_commands.cpp).
RunFunction set_up_bench(CommandLine& line);
RunFunction set_up_cache(CommandLine& line);
RunFunction set_up_compare(CommandLine& line);
RunFunction set_up_completion(CommandLine& line);
RunFunction set_up_doctor(CommandLine& line);
RunFunction set_up_check(CommandLine& line);
RunFunction set_up_export(CommandLine& line);
RunFunction set_up_format(CommandLine& line);
RunFunction set_up_init(CommandLine& line);
RunFunction set_up_learn(CommandLine& line);
RunFunction set_up_manual(CommandLine& line);
RunFunction set_up_new(CommandLine& line);
RunFunction set_up_replay(CommandLine& line);
RunFunction set_up_reproduce(CommandLine& line);
RunFunction set_up_extract(CommandLine& line);
RunFunction set_up_ros2(CommandLine& line);
RunFunction set_up_simulate(CommandLine& line);
RunFunction set_up_test(CommandLine& line);
RunFunction set_up_view(CommandLine& line);

// The options that several commands have, so that they read the same everywhere.
Argument add_seed_option(CommandLine& line, std::uint64_t& seed);
// 0: not given, the default of each system.
Argument add_jobs_option(CommandLine& line, std::size_t& jobs);
Argument add_token_option(CommandLine& line, std::string& token_file);
// "n=5", for parse_settings().
Argument add_set_option(CommandLine& line, std::vector<std::string>& settings);
// How the one system of a command is reached: the two above, and other machines
// (machine_options()). `access` must live as long as the line.
std::vector<Argument> add_access_options(CommandLine& line, SystemAccess& access);

// An option that is about wrappers on other machines; `maide help systems` tells of them.
struct MachineOption {
  std::string_view flag, value, help;
};
std::span<const MachineOption> machine_options();
// How long a running graph of ROS 2 must stay as it is.
inline constexpr double ros2_settle_seconds = 2;
Argument add_settle_option(CommandLine& line, double& settle);

// `maide doctor ros2`: of the running graph, or of the file that is named.
ExitStatus run_ros2_doctor(const std::string& file, double settle, Context& context);

// Prepares a process that is one of Maide's programs: broken pipes become errors of the write, the
// three standard streams exist, and what ends a program without an exception (a thread that throws)
// still ends it with one line.
void prepare_process();

// Parses the command line and runs the command; never throws. Returns the exit status.
int run_command_line(int argc, const char* const* argv) noexcept;

}  // namespace maide::cli
