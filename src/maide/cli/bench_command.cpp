// `maide bench FOLDER`: every learning algorithm on every model of a folder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/join.hpp"
#include "maide/cli/argument_check.hpp"
#include "maide/cli/bench_report.hpp"
#include "maide/cli/command.hpp"
#include "maide/conformance/test_chain.hpp"
#include "maide/learn/learners.hpp"

namespace maide::cli {
namespace {

struct BenchArguments {
  std::string folder;
  std::string csv;
  std::string start_from;
  BenchOptions options;
  double seconds = 60;
  bool no_cache = false;
};

// Wrong models count most, then runs that are missing, then models that could not be read.
ExitStatus status_of(std::span<const BenchRun> runs, const BenchFolder& folder, bool is_complete) {
  const auto any = [runs](BenchOutcome outcome) {
    return std::any_of(runs.begin(), runs.end(),
                       [outcome](const BenchRun& run) { return run.outcome == outcome; });
  };
  if (any(BenchOutcome::wrong)) return ExitStatus::violated;
  if (!is_complete || any(BenchOutcome::unfinished)) return ExitStatus::inconclusive;
  return folder.unreadable.empty() ? ExitStatus::ok : ExitStatus::usage;
}

ExitStatus bench(const BenchArguments& arguments, Context& context) {
  if (!arguments.csv.empty()) check_can_write(arguments.csv);
  BenchOptions options = arguments.options;
  options.seconds = arguments.seconds;
  options.use_cache = !arguments.no_cache;
  bench_learners(options);  // wrong names are found before models are read
  const TestChain tests(options.test_method);
  if (options.testing.max_tests) tests.require("max-tests");
  if (options.testing.extra_states) tests.require("extra-states");
  BenchFolder folder = read_bench_folder(arguments.folder);
  if (!arguments.start_from.empty()) add_old_versions(folder, arguments.start_from);
  for (const std::string& message : folder.unreadable) context.complain(message);
  if (folder.models.empty()) {
    throw UsageError("no model there can be learned (" + arguments.folder + ")");
  }

  BenchTable table(folder.models, options);
  std::vector<BenchRun> runs;
  context.print(table.head());
  const bool is_complete = run_bench(
      folder.models, options,
      [&](const BenchRun& run) {
        runs.push_back(run);
        context.print(table.line(run));
      },
      context.control());
  context.print(table.end(runs));
  Json json = bench_json(folder, options, runs, is_complete);
  json["start_from"] = arguments.start_from.empty() ? Json() : Json(arguments.start_from);
  context.set_result(json);
  if (!arguments.csv.empty()) {
    write_file_atomically(arguments.csv, bench_csv(folder.models, runs));
  }
  if (!is_complete) context.complain("the bench was interrupted; above is what was measured");
  return status_of(runs, folder, is_complete);
}

void add_bench_limits(CLI::App& app, BenchArguments& arguments) {
  app.add_option("--time", arguments.seconds, "Most seconds of one run")->check(check_seconds);
  app.add_option("--max-experiments", arguments.options.max_experiments,
                 "Most words that reach the system in one run; 0: no limit")
      ->check(check_count);
  app.add_option("--max-tests", arguments.options.testing.max_tests,
                 "Most tests of one equivalence query")
      ->check(check_count);
  app.add_option("--extra-states", arguments.options.testing.extra_states,
                 "How many states more than the hypothesis the system may have for the tests to "
                 "find it (--eq " +
                     methods_with("extra-states") + ")")
      ->check(check_count);
}

}  // namespace

RunFunction set_up_bench(CLI::App& app) {
  auto arguments = std::make_shared<BenchArguments>();
  arguments->options.testing.seed = 1;
  std::vector<std::string> names;
  for (const LearnerEntry& entry : learners()) names.emplace_back(entry.name);
  app.add_option("FOLDER", arguments->folder,
                 "A folder of models: .dot, .gv, .aut; an interface automaton counts as its Mealy "
                 "machine (eager)")
      ->required();
  app.add_option(
         "--algorithm", arguments->options.algorithms,
         fmt::format("A learner to measure, once or several times: {} (default: all)", join(names)))
      ->allow_extra_args(false)
      ->default_str("");
  app.add_option("--eq", arguments->options.test_method,
                 "The equivalence method, as in maide learn; several with commas between are "
                 "asked in turn, each with options of its own: "
                 "w:extra-states=1,random-hads:max-tests=5000");
  app.add_option("--start-from", arguments->start_from,
                 "A folder of models of earlier versions, by the same names: learners start from "
                 "them, as in maide learn");
  app.add_option("--csv", arguments->csv, "Write a line for each run to this file");
  app.add_flag("--no-cache", arguments->no_cache,
               "Ask the system every query; the processor time is then that of the learner, "
               "tests and simulation");
  app.add_option("-j,--jobs", arguments->options.jobs,
                 "How many runs at once; counts are the same, times may suffer. Default: one for "
                 "each processor")
      ->check(check_jobs)
      ->default_str("")
      ->type_name("K");
  add_seed_option(app, arguments->options.testing.seed);
  add_bench_limits(app, *arguments);
  return [arguments](Context& context) { return bench(*arguments, context); };
}

}  // namespace maide::cli
