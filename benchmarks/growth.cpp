// How the cost of learning grows with the size of what is learned:
//
//   bench_growth --output PREFIX [--sizes 1,2,4,8,16,32] "SYSTEM [KEY=VALUE ...]" ...
//
// learns each system for each size, which takes the place of the word N in its options, as in
// "port kind=strict size=N", and writes PREFIX.csv (all counts and times) and PREFIX.svg (seconds
// and symbols over N). A size that takes longer than --seconds is the system's last.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/report/line_plot.hpp"

namespace maide {
namespace {

struct Arguments {
  std::vector<std::string> systems;
  std::vector<std::uint64_t> sizes{1, 2, 3, 4, 6, 8, 12, 16, 24, 32};
  std::string output;
  std::string algorithm;
  std::size_t jobs = 0;
  double seconds = 600;
};

SystemSpec spec_of(const std::string& text, std::uint64_t size) {
  std::vector<std::string> words = split_shell_words(text);
  if (words.empty()) throw UsageError("a system has no name");
  for (std::string& word : words) {
    if (word.ends_with("=N")) word.replace(word.size() - 1, 1, std::to_string(size));
  }
  return parse_system_spec(words.front(), std::span(words).subspan(1));
}

struct Measured {
  LearnedModel learned;
  std::size_t jobs = 0;
};

Measured measure(const std::string& system, std::uint64_t size, const Arguments& arguments) {
  SystemAccess access;
  access.jobs = arguments.jobs;
  const OpenedSystem opened = open_system(spec_of(system, size), access);
  ExperimentOptions options;
  options.algorithm = arguments.algorithm;
  options.testing.seed = 1;
  Measured result{learn_model(*opened.sul, Translation::eager, options),
                  count_systems(*opened.sul)};
  if (result.learned.experiment.error) std::rethrow_exception(result.learned.experiment.error);
  return result;
}

constexpr const char* csv_head =
    "system,N,jobs,states,transitions,output_queries,equivalence_queries,experiments,symbols,"
    "seconds,seconds_in_calls,seconds_in_quiescence,seconds_in_reset,seconds_in_learner\n";

std::string csv_line(const std::string& system, std::uint64_t size, const Measured& measured) {
  const ExperimentResult& run = measured.learned.experiment;
  return fmt::format("\"{}\",{},{},{},{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", system,
                     size, measured.jobs, measured.learned.states(), measured.learned.transitions(),
                     run.output_queries, run.equivalence_queries, run.experiments, run.symbols,
                     run.seconds, run.seconds_in_system - run.seconds_in_settling,
                     run.seconds_in_settling, run.seconds_in_reset, run.seconds_in_learner);
}

void run(const Arguments& arguments) {
  check_can_write(arguments.output + ".csv");
  std::string csv = csv_head;
  std::vector<PlotPanel> panels{{"seconds", {}}, {"symbols given to the system", {}}};
  fmt::print("{}", csv_head);
  for (const std::string& system : arguments.systems) {
    for (PlotPanel& panel : panels) panel.lines.push_back({system, {}});
    for (const std::uint64_t size : arguments.sizes) {
      const Measured measured = measure(system, size, arguments);
      const ExperimentResult& cost = measured.learned.experiment;
      csv += csv_line(system, size, measured);
      fmt::print("{}", csv_line(system, size, measured));
      std::fflush(stdout);
      const auto x = static_cast<double>(size);
      panels[0].lines.back().points.emplace_back(x, std::max(cost.seconds, 1e-3));
      panels[1].lines.back().points.emplace_back(x, static_cast<double>(cost.symbols));
      // As it goes, for the last size may take long.
      write_file_atomically(arguments.output + ".csv", csv);
      write_file_atomically(arguments.output + ".svg", draw_plot(panels, {.x_title = "N"}));
      if (cost.seconds > arguments.seconds) break;
    }
  }
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  maide::Arguments arguments;
  CLI::App app("How the cost of learning grows with the size of what is learned");
  app.add_option("-o,--output", arguments.output, "Writes OUTPUT.csv and OUTPUT.svg")->required();
  app.add_option("--sizes", arguments.sizes, "What N stands for")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--algorithm", arguments.algorithm, "As in maide learn");
  app.add_option("--jobs", arguments.jobs, "As in maide learn");
  app.add_option("--seconds", arguments.seconds, "No larger size after one that took longer")
      ->capture_default_str();
  app.add_option("SYSTEM", arguments.systems, "\"port kind=strict size=N\"")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    maide::run(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_growth: {}\n", error.what());
    return static_cast<int>(error.status());
  }
  return 0;
}
