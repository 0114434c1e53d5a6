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

#include <algorithm>
#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "learner_cost.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/numbers.hpp"
#include "maide/report/line_plot.hpp"
#include "model_folder.hpp"

namespace maide::bench {
namespace {

void print(const std::string& model, std::string_view algorithm, const LearnerCost& cost,
           std::string_view remark) {
  fmt::print("{:<40} {:<14} {:>10} {:>12} {:>6} {:>9.4f}{}\n", model, algorithm, cost.counts.resets,
             cost.counts.symbols, cost.equivalence_queries, cost.cpu_seconds, remark);
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

// All models by one algorithm; false if one was learned wrongly.
bool run(const std::vector<Model>& models, const LearnerEntry& algorithm, bool use_cache) {
  const std::string name = std::string(algorithm.name) + (use_cache ? ", cached" : "");
  bool all_right = true;
  LearnerCost sum;
  for (const Model& model : models) {
    const LearnerCost cost = measure_learner(algorithm, model.machine, use_cache);
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
      models.size(), name, static_cast<double>(sum.symbols_and_resets()) / count,
      static_cast<double>(sum.equivalence_queries) / count, sum.cpu_seconds);
  return all_right;
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
        const LearnerCost cost =
            measure_learner_apart(*algorithm, make_random_machine(states), use_cache);
        all_right = all_right && cost.is_right;
        const std::string line = fmt::format(
            "\"{}\",{},10,{},{},{},{:.4f},{}\n", name, states, cost.counts.resets,
            cost.counts.symbols, cost.equivalence_queries, cost.cpu_seconds, cost.peak_bytes);
        fmt::print("{}", line);
        csv += line;
        const auto x = static_cast<double>(states);
        panels[0].lines.back().points.emplace_back(x, std::max(cost.cpu_seconds, 1e-3));
        panels[1].lines.back().points.emplace_back(x, static_cast<double>(cost.peak_bytes) / 1e6);
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
  for (std::size_t i = own; i < words.size(); ++i)
    algorithms.push_back(&find_deterministic_learner(words[i]));
  if (algorithms.empty()) {
    for (const LearnerEntry& entry : deterministic_learners()) algorithms.push_back(&entry);
  }
  if (first == "--growth") return run_growth(words[1], parse_sizes(words[2]), algorithms) ? 0 : 1;
  std::vector<Model> models;
  if (first == "--random") {
    for (const std::size_t states : parse_sizes(words[1]))
      models.push_back({"random", make_random_machine(states)});
  } else {
    models = read_models(first);
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
}  // namespace maide::bench

int main(int argc, char** argv) {
  try {
    return maide::bench::run_all({argv, static_cast<std::size_t>(argc)});
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_learn: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
