// Learners x models, with the perfect oracle: resets, symbols, equivalence queries, CPU seconds.
//
//   bench_learn FOLDER [ALGORITHM ...]
//   bench_learn --random STATES,STATES,... [ALGORITHM ...]
//
// FOLDER holds Mealy machines as .dot files. Each is learned twice by each algorithm: asking the
// system for every output query, as published figures count them, and through the cache. Exit
// status 1 if a learned machine is not equivalent to its model. With --random the machines are
// random ones of these sizes with 10 inputs and 10 outputs, always the same: how does the cost
// grow?
#include <fmt/format.h>

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
#include "maide/base/parse_number.hpp"
#include "maide/conformance/perfect_oracle.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache.hpp"
#include "maide/learn/counting_oracle.hpp"
#include "maide/learn/learners.hpp"
#include "maide/learn/mealy_oracle.hpp"

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

// Random machines of these numbers of states, separated by commas.
std::vector<Model> make_random(const std::string& sizes) {
  std::vector<Model> models;
  std::istringstream list(sizes);
  for (std::string text; std::getline(list, text, ',');) {
    const auto states = parse_number<std::size_t>(text);
    if (!states || *states == 0) throw UsageError("'" + text + "' is no number of states");
    Random random(*states);
    models.push_back(
        {"random", random_mealy({.states = *states, .inputs = 10, .outputs = 10}, random)});
  }
  return models;
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

int run_all(std::span<char*> arguments) {
  const bool is_random = arguments.size() > 2 && std::string(arguments[1]) == "--random";
  if (arguments.size() < 2) {
    throw UsageError("usage: bench_learn FOLDER|--random STATES,... [ALGORITHM ...]");
  }
  const std::vector<Model> models =
      is_random ? make_random(arguments[2]) : read_folder(arguments[1]);
  std::vector<const LearnerEntry*> algorithms;
  for (const char* name : arguments.subspan(is_random ? 3 : 2))
    algorithms.push_back(&find_learner(name));
  if (algorithms.empty()) {
    for (const LearnerEntry& entry : learners()) algorithms.push_back(&entry);
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
