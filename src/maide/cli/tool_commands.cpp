#include "maide/cli/tool_commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/learn/learner.hpp"

namespace maide::cli {
namespace {

std::string find_tool(const std::string& name) {
  if (const auto file = find_own_program(name)) return file->string();
  throw UsageError(
      fmt::format("{} is neither beside maide nor in ../libexec/maide: it is built and "
                  "installed with everything else, and by its name (cmake --build ... "
                  "--target {})",
                  name, name));
}

// In this process: its streams, terminal, signals and exit status are the program's from here on.
[[noreturn]] void become(std::vector<std::string> command) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  ::execv(words.front(), words.data());
  throw UsageError(command.front() +
                   " cannot be started: " + std::generic_category().message(errno));
}

// Within another program: what it prints under --json is the result.
ExitStatus run_embedded(std::vector<std::string> command, Context& context) {
  command.emplace_back("--json");
  const SubprocessResult run = run_program(command, {}, context.control());
  Json result = parse_json(run.out, command.front());
  const auto status = static_cast<ExitStatus>(run.exit_status);
  const std::string error = result.value("error", "");
  for (const char* member : {"schema", "error", "status"}) result.erase(member);
  if (!error.empty() && result.empty()) {
    if (status == ExitStatus::usage) throw UsageError(error);
    throw Error(status, error);
  }
  context.set_result(result);
  return error.empty() ? status : context.fail(error, status);
}

template <typename Arguments>
RunFunction set_up(const std::string& tool, CommandLine& line,
                   void (*declare)(CommandLine& line, Arguments& arguments)) {
  auto arguments = std::make_shared<Arguments>();
  declare(line, *arguments);
  return [arguments, tool, &line](Context& context) {
    std::vector<std::string> command{find_tool(tool)};
    command.insert(command.end(), line.typed().begin(), line.typed().end());
    if (context.embedded()) return run_embedded(std::move(command), context);
    become(std::move(command));
  };
}

}  // namespace

void declare_bench(CommandLine& line, BenchArguments& arguments) {
  std::vector<std::string> names;
  for (const LearnerEntry& entry : deterministic_learners()) names.emplace_back(entry.name);
  line.add("FOLDER", arguments.folder,
           "A folder of models: .dot, .gv, .aut. An interface automaton counts as its Mealy "
           "machine (eager)")
      .required();
  line.add("--algorithm", arguments.algorithms,
           "A learner to measure, once or more. Default: all ('maide help algorithms')")
      .check([names](const std::string& name) { return check_one_of(name, names); })
      .one_each()
      .no_default()
      .value_name("NAME");
  add_test_options(line, arguments.tests);
  line.add("--start-from", arguments.start_from,
           "A folder of models of earlier versions. By the same names: learners start from them, "
           "as in maide learn")
      .value_name("FOLDER");
  line.add("--csv", arguments.csv, "Write a line for each run to this file").value_name("FILE");
  line.add_flag("--no-cache", arguments.no_cache,
                "Ask the system every query. The processor time is then that of the learner, the "
                "tests and the simulation");
  line.add("-j,--jobs", arguments.jobs,
           "How many runs at once. Counts are the same, times may suffer. Default: one for "
           "each processor")
      .check(check_jobs)
      .no_default()
      .value_name("K");
  add_seed_option(line, arguments.seed);
  line.add("--time", arguments.seconds, "Most seconds of one run").check(check_seconds);
  line.add("--max-experiments", arguments.max_experiments,
           "Most words that reach the system in one run; 0: no limit");
}

void declare_reproduce(CommandLine& line, ReproduceArguments& arguments) {
  line.add("WHAT", arguments.what, "Which result: table1 (learning), table2 (checking), interrupt")
      .required()
      .check([](const std::string& what) {
        return check_one_of(what, {"table1", "table2", "interrupt"});
      });
  line.add("--system", arguments.systems,
           fmt::format("Learn from this system. Which: {} (default: all that are built here; for "
                       "table2, port)",
                       fmt::join(reproduced_systems, ", ")))
      .no_default();
  line.add("--algorithm", arguments.algorithm, "As in maide learn; the paper's is lmplus");
  line.add("--eq", arguments.test_method, "As in maide learn");
  add_jobs_option(line, arguments.jobs);
  add_seed_option(line, arguments.seed);
}

RunFunction set_up_bench(CommandLine& line) {
  return set_up<BenchArguments>("maide-bench", line, declare_bench);
}

RunFunction set_up_reproduce(CommandLine& line) {
  return set_up<ReproduceArguments>("maide-reproduce", line, declare_reproduce);
}

}  // namespace maide::cli
