// From argv to exit status.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/log.hpp"
#include "maide/base/run_control.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/mpi.hpp"
#include "maide/cli/terminal.hpp"
#include "maide/cli/tool_commands.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide::cli {

namespace {

constexpr std::string_view exit_statuses =
    "Exit status: 0 it holds, they agree, done; 1 violated, they differ; 2 unusable\n"
    "arguments or input; 3 inconclusive (a bound, a limit, a weak model, Ctrl-C);\n"
    "4 the system under learning failed; 5 an error of Maide's own.\n";

// Options of every command, as its help shows them.
constexpr std::string_view common_help =
    "Every command: --json (one JSON object), -q, -v (say less, more), -h,\n"
    "  --color auto|always|never. All of each option: --help -v\n";

// What `maide` alone prints.
std::string overview() {
  std::vector<TextRow> rows;
  for (const Command& command : command_table()) {
    rows.emplace_back(std::string(command.name), std::string(command.summary));
  }
  constexpr std::size_t widest = 12;
  return wrap("Maide " + std::string(version()) +
                  " learns models of robot middleware by experimenting with the real thing, and "
                  "checks control programs against them.",
              help_width(), 0) +
         "\nCommands:\n" + two_columns(rows, help_width(), widest) +
         "\n`maide COMMAND --help` tells more about a command, with an example. Pages:\n" +
         describe_help_pages() + "\n" + std::string(exit_statuses);
}

std::string footer(const Command& command) {
  std::string text = std::string(common_help) + "\nExample:\n";
  for (const std::string_view line : split_lines(command.examples)) {
    text += "  " + std::string(line) + "\n";
  }
  return text + "\n" + std::string(exit_statuses);
}

// `with_pages`: pages of the help, too, are suggested for a name that is near.
const Command& find_command(const std::string& name, bool with_pages = false) {
  std::vector<std::string> names;
  for (const Command& command : command_table()) {
    if (command.name == name) return command;
    names.emplace_back(command.name);
  }
  for (const HelpPage& page : help_pages()) {
    if (with_pages) names.emplace_back(page.name);
  }
  for (const char* other : {"help", "--help", "--version"}) names.emplace_back(other);
  throw UsageError((name.starts_with("-") ? "unknown option '" : "unknown command '") + name + "'" +
                   did_you_mean(name, names) + " (see 'maide --help')");
}

ExitStatus run(const Command& command, const std::vector<std::string>& typed) {
  const std::string hint = " (see 'maide " + std::string(command.name) + " --help')";
  DeclaredCommand declared(command);
  CommandLine& line = declared.line;
  const CommonOptions& common = declared.common;
  const std::string& color = declared.color;
  if (!line.parse(typed, hint)) {
    const bool is_full = std::ranges::any_of(
        typed, [](const std::string& word) { return word == "-v" || word == "--verbose"; });
    write_to_stdout(line.help(help_width(), is_full));
    return ExitStatus::ok;
  }
  set_color_mode(color == "auto"     ? ColorMode::automatic
                 : color == "always" ? ColorMode::always
                                     : ColorMode::never);
  if (common.quiet && common.verbose) throw UsageError("-q and -v exclude each other" + hint);
  set_up_log("maide", common.quiet     ? LogLevel::quiet
                      : common.verbose ? LogLevel::verbose
                                       : LogLevel::normal);
  const Interrupt interrupt;
  Context context(common, interrupt.token());
  const ExitStatus status = declared.run(context);
  context.finish(status);
  return status;
}

ExitStatus dispatch(std::vector<std::string> arguments) {
  if (arguments.empty()) {
    write_to_stdout(overview());
    return ExitStatus::ok;
  }
  std::string name = arguments.front();
  arguments.erase(arguments.begin());
  if (name == "--help" || name == "-h" || name == "help") {
    if (arguments.empty()) {
      write_to_stdout(overview());
      return ExitStatus::ok;
    }
    name = arguments.front();
    if (const HelpPage* page = find_help_page(name)) {
      write_to_stdout(page->text(help_width()));
      return ExitStatus::ok;
    }
    find_command(name, true);
    arguments.front() = "--help";
  }
  if (name == "--version") {
    write_to_stdout("maide " + std::string(version()) + "\n");
    return ExitStatus::ok;
  }
  return run(find_command(name), arguments);
}

// The one place where an error becomes output. `excerpt`: of the text in which it is, or "".
int report(const std::string& message, ExitStatus status, bool json,
           const std::string& excerpt = "") {
  write_error_line(message);
  std::fputs(printable(excerpt).c_str(), stderr);
  if (json) {
    try {
      const Json object{
          {"schema", json_schema}, {"error", message}, {"status", static_cast<int>(status)}};
      write_data(to_json_line(object) + "\n");
    } catch (const Error&) {  // standard output is what failed; the line above says so
    }
  }
  return static_cast<int>(status);
}

// A standard stream that the caller closed would otherwise be the first file that we open, and the
// result would go there. Opened the wrong way round, it fails when it is used.
void hold_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) == -1 && errno == EBADF) {
      ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
  }
}

[[noreturn]] void end_after_uncaught_exception() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
    write_error_line(describe_internal_error(""));
  } catch (const std::exception& error) {
    write_error_line(describe_internal_error(error.what()));
  } catch (...) {
    write_error_line(describe_internal_error(""));
  }
  ::_exit(static_cast<int>(ExitStatus::internal));
}

// Runs it, and makes output and an exit status of what it throws.
template <typename Work>
int run_reporting(int argc, const char* const* argv, Work&& work) noexcept {
  bool json = false;
  try {
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    json = std::ranges::find(arguments, "--json") != arguments.end();
    return static_cast<int>(work(arguments));
  } catch (const UsageError& error) {
    // Of several ranks the first says it.
    if (is_later_rank()) return static_cast<int>(error.status());
    return report(error.what(), error.status(), json);
  } catch (const ParseError& error) {
    return report(error.what(), error.status(), json, source_excerpt(error.position()));
  } catch (const Error& error) {
    return report(error.what(), error.status(), json);
  } catch (const std::bad_alloc&) {
    return report("out of memory", ExitStatus::inconclusive, json);
  } catch (const std::exception& error) {
    return report(describe_internal_error(error.what()), ExitStatus::internal, json);
  } catch (...) {
    return report(describe_internal_error(""), ExitStatus::internal, json);
  }
}

}  // namespace

void prepare_process() {
  hold_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  std::set_terminate(end_after_uncaught_exception);
}

DeclaredCommand::DeclaredCommand(const Command& command)
    : line("maide " + std::string(command.name), std::string(command.summary)),
      run(command.set_up(line)) {
  line.add_flag("--json", common.json, "Print one JSON object instead of text");
  line.add_flag("-q,--quiet", common.quiet, "No progress line, no notes, short results");
  line.add_flag("-v,--verbose", common.verbose, "Say more about what is done");
  line.add("--color", color, "When there are colours: auto is on a terminal, without NO_COLOR")
      .one_of({"auto", "always", "never"})
      .value_name("WHEN");
  for (Argument argument : line.all()) {
    static const std::vector<std::string> shown_below{"--help", "--json", "--quiet", "--verbose",
                                                      "--color"};
    const bool is_common = std::ranges::find(shown_below, argument.name()) != shown_below.end();
    if (is_common) argument.topic(CommandLine::shown_in_footer);
  }
  line.set_footer(footer(command));
}

std::string_view describe_exit_statuses() { return exit_statuses; }

Argument add_seed_option(CommandLine& line, std::uint64_t& seed) {
  return line.add("--seed", seed, "Seed of everything random. The same seed gives the same run")
      .value_name("N");
}

Argument add_jobs_option(CommandLine& line, std::size_t& jobs) {
  return line
      .add("-j,--jobs", jobs,
           "How many systems to ask at once. The result is the same. Default: one for each "
           "processor of a wrapper by name, one for each host of tcp://, else 1")
      .check(check_jobs)
      .no_default()
      .value_name("K");
}

Argument add_token_option(CommandLine& line, std::string& token_file) {
  return line
      .add("--token-file", token_file,
           "A file with the token of wrappers that listen or dial in. Or set MAIDE_TOKEN")
      .value_name("FILE");
}

Argument add_set_option(CommandLine& line, std::vector<std::string>& settings) {
  return line
      .add(
          "--set", settings,
          "Another value for a constant of the system file: --set n=5. May be given more than once")
      .no_default()
      .one_each()
      .value_name("NAME=VALUE");
}

std::span<const MachineOption> machine_options() {
  static constexpr std::array options{
      MachineOption{"--launch", "COMMAND",
                    "Starts a wrapper on each of --hosts: 'ssh {host} {wrapper}'. It speaks over "
                    "the command's standard input and output. {wrapper} is the wrapper's program, "
                    "found there on PATH; 'ssh {host} /usr/libexec/maide/{wrapper}' finds it "
                    "elsewhere"},
      MachineOption{"--hosts", "FILE",
                    "A host a line, and how many wrappers run there if it is not one: 'robot1 2'. "
                    "A host that cannot be started or dies is left out; the run is the same"},
      MachineOption{"--accept", "HOST:PORT",
                    "Waits here for wrappers that dial in: maide-wrap-NAME --connect HOST:PORT. "
                    "Late ones take part at once; the run is the same"},
      MachineOption{"--accept-wait", "SECONDS",
                    "How long to wait for a wrapper while there is none (default: 300)"},
  };
  return options;
}

std::vector<Argument> add_access_options(CommandLine& line, SystemAccess& access) {
  std::vector<Argument> added{add_token_option(line, access.token_file),
                              add_jobs_option(line, access.jobs)};
  std::size_t next = 0;
  const auto add = [&](auto& value) {
    const MachineOption& option = machine_options()[next++];
    added.push_back(line.add(std::string(option.flag), value, std::string(option.help))
                        .no_default()
                        .value_name(std::string(option.value))
                        .topic("systems"));
  };
  add(access.launch);
  add(access.hosts_file);
  add(access.accept);
  add(access.accept_wait);
  added.back().check(check_seconds);
  MAIDE_CHECK(next == machine_options().size());
  return added;
}

int run_command_line(int argc, const char* const* argv) noexcept {
  return run_reporting(argc, argv, dispatch);
}

int run_tool(std::string_view name, RunFunction (*set_up)(CommandLine& line), int argc,
             const char* const* argv) noexcept {
  return run_reporting(argc, argv, [&](const std::vector<std::string>& words) {
    Command command = find_command(std::string(name));
    command.set_up = set_up;
    return run(command, words);
  });
}

}  // namespace maide::cli
