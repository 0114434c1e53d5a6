// `maide reproduce`: the paper's results, theirs beside ours, learned anew from the systems that
// are there. Equal sizes are expected; equal counts are not (other hardware, other equivalence
// tests).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/reproduce.hpp"
#include "maide/workflow/open_system.hpp"
#include "maide/workflow/paper_tables.hpp"
#include "maide/workflow/wrapper_search.hpp"

namespace maide::cli {
namespace {

constexpr const char* line_format =
    "{:<28} {:>4} {:>4} {:>6} {:>4} {:>6} {:>8}  | {:>4} {:>4} {:>6} {:>4} {:>6} {:>8}\n";

std::string table_head(const std::string& system) {
  return fmt::format("\nTable 1, learned from {}\n{:<28} {:^37}  | {}\n", system, "", "here",
                     "the paper (YARP, 2014)") +
         fmt::format(line_format, "model", "|Q|", "|T|", "#MM", "#EQ", "#exp", "s", "|Q|", "|T|",
                     "#MM", "#EQ", "#exp", "s");
}

std::string table_line(const PaperLearningRow& paper, const LearnedModel& learned) {
  const ExperimentResult& run = learned.experiment;
  const bool same_size =
      learned.states() == paper.states && learned.transitions() == paper.transitions;
  return fmt::format(line_format, paper.configuration + (same_size ? "" : "  (!)"),
                     learned.states(), learned.transitions(), run.output_queries,
                     run.equivalence_queries, run.experiments, fmt::format("{:.2f}", run.seconds),
                     paper.states, paper.transitions, paper.output_queries,
                     paper.equivalence_queries, paper.experiments,
                     fmt::format("{:.0f}", paper.thousand_seconds * 1000));
}

Json row_json(const std::string& system, const ReproducedRow& row, const LearnedModel& learned) {
  const ExperimentResult& run = learned.experiment;
  const PaperLearningRow& paper = row.paper;
  return {{"system", system},
          {"options", row.options},
          {"model", paper.configuration},
          {"states", learned.states()},
          {"transitions", learned.transitions()},
          {"output_queries", run.output_queries},
          {"equivalence_queries", run.equivalence_queries},
          {"experiments", run.experiments},
          {"seconds", run.seconds},
          {"paper",
           {{"states", paper.states},
            {"transitions", paper.transitions},
            {"output_queries", paper.output_queries},
            {"equivalence_queries", paper.equivalence_queries},
            {"experiments", paper.experiments},
            {"seconds", paper.thousand_seconds * 1000}}}};
}

ExitStatus reproduce_table1(const ReproduceArguments& arguments, Context& context) {
  Json rows = Json::array();
  bool all_equal = true;
  for (const std::string& system : chosen_systems(table1_systems(), arguments, context)) {
    const std::vector<ReproducedRow> table = table1_rows(system);
    context.print(table_head(system));
    for (const ReproducedRow& row : table) {
      const LearnedModel learned =
          learn_for_reproduction(system, row.options, arguments, context.control());
      context.print(table_line(row.paper, learned));
      rows.push_back(row_json(system, row, learned));
      all_equal = all_equal && learned.states() == row.paper.states &&
                  learned.transitions() == row.paper.transitions;
    }
  }
  context.print(
      "\n|Q| states, |T| transitions, #MM output queries, #EQ equivalence queries, #exp words run "
      "on the system.\n* with a non-blocking read; writes beyond the bound drawn as self-loops. "
      "(!): another size than the paper's.\n");
  context.set_result({{"table", "table1"}, {"sizes_equal", all_equal}, {"rows", rows}});
  return all_equal ? ExitStatus::ok : ExitStatus::violated;
}

}  // namespace

LearnedModel learn_for_reproduction(const std::string& system,
                                    const std::map<std::string, std::string>& options,
                                    const ReproduceArguments& arguments,
                                    const RunControl& control) {
  SystemSpec spec = parse_system_spec(system, {});
  spec.options = options;
  SystemAccess access;
  access.jobs = arguments.jobs;
  const OpenedSystem opened = open_system(spec, access, control);
  ExperimentOptions experiment;
  experiment.algorithm = arguments.algorithm;
  experiment.test_method = arguments.test_method;
  experiment.testing.seed = arguments.seed;
  LearnedModel learned = learn_model(*opened.sul, Translation::eager, experiment, control);
  if (!learned.experiment.is_complete()) std::rethrow_exception(learned.experiment.error);
  return learned;
}

std::vector<std::string> chosen_systems(const std::vector<std::string>& known,
                                        const ReproduceArguments& arguments, Context& context) {
  for (const std::string& asked : arguments.systems) {
    if (std::find(known.begin(), known.end(), asked) != known.end()) continue;
    throw UsageError(fmt::format("there is nothing to reproduce on '{}'; there is on {}", asked,
                                 fmt::join(known, ", ")));
  }
  if (!arguments.systems.empty()) return arguments.systems;
  std::vector<std::string> systems;
  for (const std::string& system : known) {
    if (find_wrapper(system)) {
      systems.emplace_back(system);
    } else if (!context.quiet()) {
      context.complain(fmt::format("{} is left out: its wrapper is not built here", system));
    }
  }
  if (systems.empty()) throw UsageError("no wrapper was found; " + describe_wrapper_search());
  return systems;
}

RunFunction set_up_reproduce(CLI::App& app) {
  auto arguments = std::make_shared<ReproduceArguments>();
  app.add_option("WHAT", arguments->what,
                 "Which result of the paper: table1 (learning), table2 (checking), interrupt")
      ->required()
      ->check([](const std::string& what) {
        if (what == "table1" || what == "table2" || what == "interrupt") return std::string();
        return "there is no '" + what + "' to reproduce; there is table1, table2, interrupt";
      });
  app.add_option("--system", arguments->systems,
                 fmt::format("Learn from this system: {} (default: all that are built here; for "
                             "table2, port)",
                             fmt::join(table1_systems(), ", ")))
      ->default_str("");
  app.add_option("--algorithm", arguments->algorithm, "As in maide learn; the paper's is lmplus");
  app.add_option("--eq", arguments->test_method, "As in maide learn");
  add_jobs_option(app, arguments->jobs);
  add_seed_option(app, arguments->seed);
  return [arguments](Context& context) {
    if (arguments->what == "table1") return reproduce_table1(*arguments, context);
    if (arguments->what == "table2") return reproduce_table2(*arguments, context);
    return reproduce_interrupt(*arguments, context);
  };
}

}  // namespace maide::cli
