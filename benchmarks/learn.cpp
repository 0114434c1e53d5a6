// Learners x models, with the perfect oracle: resets, symbols, equivalence queries, CPU seconds.
//
//   bench_learn FOLDER [ALGORITHM ...]
//   bench_learn --random STATES,STATES,... [ALGORITHM ...]
//   bench_learn --growth PREFIX STATES,STATES,... [ALGORITHM ...]
//
// FOLDER holds Mealy machines as .dot files. Each is learned twice by each algorithm: asking the
// system for every output query, as published figures count them, and through the cache. Exit
// status 1 if a learned machine is not equivalent to its model. With --random the machines are
// random ones of these sizes with 10 inputs and 10 outputs, always the same. With --growth each is
// learned in a process of its own, whose peak of memory counts, and PREFIX.csv and PREFIX.svg are
// written: how do time and memory grow? An algorithm gets no larger machine after one that took
// longer than two minutes.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/parse_number.hpp"
#include "maide/conformance/perfect_oracle.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache.hpp"
#include "maide/learn/counting_oracle.hpp"
#include "maide/learn/learners.hpp"
#include "maide/learn/mealy_oracle.hpp"
#include "maide/report/line_plot.hpp"

namespace maide {
namespace {

struct Cost {
  QueryCounts counts;
  std::uint64_t equivalence_queries = 0;
  double cpu_seconds = 0;
  bool is_right = false;
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Cost measure(const LearnerEntry& algorithm, const Mealy& model, bool use_cache) {
  Cost cost;
  const double start = cpu_seconds();
  MealyOracle system(model);
  CountingOracle counter(system);
  Cache cache(counter);
  PerfectOracle teacher(model);
  const auto learner = algorithm.make(use_cache ? static_cast<OutputOracle&>(cache) : counter);
  const LearnResult result = run_learner(*learner, teacher);
  cost.cpu_seconds = cpu_seconds() - start;
  cost.counts = counter.statistics().total();
  cost.equivalence_queries = result.equivalence_queries;
  cost.is_right =
      !find_difference(result.model, model) && result.model.size() == minimize(model).size();
  return cost;
}

void print(const std::string& model, std::string_view algorithm, const Cost& cost,
           std::string_view remark) {
  fmt::print("{:<40} {:<14} {:>10} {:>12} {:>6} {:>9.4f}{}\n", model, algorithm, cost.counts.resets,
             cost.counts.symbols, cost.equivalence_queries, cost.cpu_seconds, remark);
}

struct Model {
  std::string name;
  Mealy machine;
};

std::vector<Model> read_folder(const std::filesystem::path& folder) {
  std::vector<Model> models;
  if (!std::filesystem::is_directory(folder)) {
    throw UsageError("there is no folder " + folder.string());
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".dot") continue;
    models.push_back({entry.path().stem().string(), read_mealy(entry.path())});
  }
  std::sort(models.begin(), models.end(),
            [](const Model& left, const Model& right) { return left.name < right.name; });
  if (models.empty()) throw UsageError("no .dot files in " + folder.string());
  return models;
}

// Numbers of states, separated by commas.
std::vector<std::size_t> parse_sizes(const std::string& sizes) {
  std::vector<std::size_t> result;
  std::istringstream list(sizes);
  for (std::string text; std::getline(list, text, ',');) {
    const auto states = parse_number<std::size_t>(text);
    if (!states || *states == 0) throw UsageError("'" + text + "' is no number of states");
    result.push_back(*states);
  }
  return result;
}

Model make_random(std::size_t states) {
  Random random(states);
  return {"random", random_mealy({.states = states, .inputs = 10, .outputs = 10}, random)};
}

// All models by one algorithm; false if one was learned wrongly.
bool run(const std::vector<Model>& models, const LearnerEntry& algorithm, bool use_cache) {
  const std::string name = std::string(algorithm.name) + (use_cache ? ", cached" : "");
  bool all_right = true;
  Cost sum;
  for (const Model& model : models) {
    const Cost cost = measure(algorithm, model.machine, use_cache);
    all_right = all_right && cost.is_right;
    sum.counts += cost.counts;
    sum.equivalence_queries += cost.equivalence_queries;
    sum.cpu_seconds += cost.cpu_seconds;
    print(fmt::format("{} {}x{}", model.name, model.machine.size(), model.machine.inputs().size()),
          name, cost, cost.is_right ? "" : "  WRONG");
  }
  const auto count = static_cast<double>(models.size());
  fmt::print(
      "mean of {} models, {}: {:.0f} symbols + resets, {:.1f} equivalence queries; "
      "{:.3f} s CPU in all\n\n",
      models.size(), name, static_cast<double>(sum.counts.symbols + sum.counts.resets) / count,
      static_cast<double>(sum.equivalence_queries) / count, sum.cpu_seconds);
  return all_right;
}

struct Grown {
  Cost cost;
  std::uint64_t peak_bytes = 0;  // resident; the model and the perfect oracle included
};

// In a process of its own, so that its peak of memory is its own.
Grown measure_apart(const LearnerEntry& algorithm, std::size_t states, bool use_cache) {
  int ends[2];
  if (pipe(ends) != 0) throw Error(ExitStatus::inconclusive, "no pipe");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) throw Error(ExitStatus::inconclusive, "no process could be started");
  if (child == 0) {
    const Cost cost = measure(algorithm, make_random(states).machine, use_cache);
    _exit(write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
  }
  close(ends[1]);
  Grown grown;
  const bool was_read = read(ends[0], &grown.cost, sizeof grown.cost) == sizeof grown.cost;
  close(ends[0]);
  rusage usage{};
  int status = 0;
  if (wait4(child, &status, 0, &usage) != child || status != 0 || !was_read) {
    throw Error(ExitStatus::inconclusive,
                fmt::format("{} states with {} could not be learned", states, algorithm.name));
  }
  grown.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  return grown;
}

// CSV and picture, as it goes, for the last size may take long; false if one was learned wrongly.
bool run_growth(const std::string& prefix, const std::vector<std::size_t>& sizes,
                std::span<const LearnerEntry* const> algorithms) {
  constexpr double most_seconds = 120;
  std::string csv =
      "algorithm,states,inputs,resets,symbols,equivalence_queries,cpu_seconds,peak_bytes\n";
  fmt::print("{}", csv);
  std::vector<PlotPanel> panels{{"seconds of the processor", {}}, {"megabytes", {}}};
  bool all_right = true;
  for (const LearnerEntry* algorithm : algorithms) {
    for (const bool use_cache : {false, true}) {
      const std::string name = std::string(algorithm->name) + (use_cache ? ", cached" : "");
      for (PlotPanel& panel : panels) panel.lines.push_back({name, {}});
      for (const std::size_t states : sizes) {
        const auto [cost, peak_bytes] = measure_apart(*algorithm, states, use_cache);
        all_right = all_right && cost.is_right;
        const std::string line = fmt::format(
            "\"{}\",{},10,{},{},{},{:.4f},{}\n", name, states, cost.counts.resets,
            cost.counts.symbols, cost.equivalence_queries, cost.cpu_seconds, peak_bytes);
        fmt::print("{}", line);
        csv += line;
        const auto x = static_cast<double>(states);
        panels[0].lines.back().points.emplace_back(x, std::max(cost.cpu_seconds, 1e-3));
        panels[1].lines.back().points.emplace_back(x, static_cast<double>(peak_bytes) / 1e6);
        write_file_atomically(prefix + ".csv", csv);
        write_file_atomically(prefix + ".svg", draw_plot(panels, {.x_title = "states, 10 inputs",
                                                                  .x = PlotScale::powers_of_ten}));
        if (cost.cpu_seconds > most_seconds) break;
      }
    }
  }
  return all_right;
}

int run_all(std::span<char*> arguments) {
  std::vector<std::string> words(arguments.begin() + 1, arguments.end());
  std::string first = words.empty() ? "" : words.front();
  const std::size_t own = first == "--growth" ? 3 : first == "--random" ? 2 : 1;
  if (words.size() < own) {
    throw UsageError(
        "usage: bench_learn FOLDER|--random STATES,...|--growth PREFIX STATES,... [ALGORITHM ...]");
  }
  std::vector<const LearnerEntry*> algorithms;
  for (std::size_t i = own; i < words.size(); ++i) algorithms.push_back(&find_learner(words[i]));
  if (algorithms.empty()) {
    for (const LearnerEntry& entry : learners()) algorithms.push_back(&entry);
  }
  if (first == "--growth") return run_growth(words[1], parse_sizes(words[2]), algorithms) ? 0 : 1;
  std::vector<Model> models;
  if (first == "--random") {
    for (const std::size_t states : parse_sizes(words[1])) models.push_back(make_random(states));
  } else {
    models = read_folder(first);
  }
  fmt::print("{:<40} {:<14} {:>10} {:>12} {:>6} {:>9}\n", "model", "learner", "resets", "symbols",
             "EQ", "CPU s");
  bool all_right = true;
  for (const LearnerEntry* algorithm : algorithms) {
    for (const bool use_cache : {false, true}) {
      all_right = run(models, *algorithm, use_cache) && all_right;
    }
  }
  return all_right ? 0 : 1;
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  try {
    return maide::run_all({argv, static_cast<std::size_t>(argc)});
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_learn: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
