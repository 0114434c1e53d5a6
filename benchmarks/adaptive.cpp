// Learning the next version of a system: what does a model of the version before save?
//
//   bench_adaptive FOLDER [--mutants N]
//
// FOLDER holds Mealy machines as .dot files. Files whose names differ in the version alone
// (OpenSSL_1.0.1g_server_regular, OpenSSL_1.0.1j_server_regular) are versions of one system, in the
// order of these; each is learned with and without its predecessor. With --mutants also N random
// mutants of each machine, with 0, 1, 2, 4 and 16 changes, are learned from the machine. The
// perfect oracle answers equivalence queries and there is no cache: the figures are the learner's
// alone. Exit status 1 if a learned machine is not equivalent to its model.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

struct Cost {
  std::uint64_t queries = 0;  // symbols + resets
  std::uint64_t equivalence_queries = 0;
  bool is_right = true;
  Cost& operator+=(const Cost& other) {
    queries += other.queries;
    equivalence_queries += other.equivalence_queries;
    is_right = is_right && other.is_right;
    return *this;
  }
};

// Without an old model if that is null.
Cost measure(const LearnerEntry& algorithm, const Mealy& model, const Mealy* old_model) {
  MealyOracle system(model);
  CountingOracle counter(system);
  Cache cache(counter);
  std::vector<std::unique_ptr<EquivalenceOracle>> links;
  if (auto words = first_words(algorithm, old_model, model.inputs()); !words.empty()) {
    links.push_back(std::make_unique<KnownWords>(cache, std::move(words)));
  }
  links.push_back(std::make_unique<PerfectOracle>(model));
  ChainOracle teacher(std::move(links));
  const auto learner = make_learner(algorithm, cache, old_model);
  const LearnResult result = run_learner(*learner, teacher);
  const QueryCounts counts = counter.statistics().total();
  return {counts.symbols + counts.resets, result.equivalence_queries,
          !find_difference(result.model, model) && result.model.size() == minimize(model).size()};
}

struct Model {
  std::string system, version;  // the file's name without the version, and that
  Mealy machine;
};

bool is_version(const std::string& part) {
  return !part.empty() && part.front() >= '0' && part.front() <= '9' &&
         part.find('.') != std::string::npos;
}

Model read(const std::filesystem::path& path) {
  Model model{"", "", minimize(read_mealy(path))};
  const std::string stem = path.stem().string();
  for (std::size_t begin = 0; begin <= stem.size();) {
    const std::size_t end = std::min(stem.find('_', begin), stem.size());
    const std::string part = stem.substr(begin, end - begin);
    if (model.version.empty() && is_version(part)) {
      model.version = part;
    } else {
      model.system += (model.system.empty() ? "" : "_") + part;
    }
    begin = end + 1;
  }
  return model;
}

// 3.3.8 comes before 3.3.12.
bool is_earlier(std::string_view left, std::string_view right) {
  const auto is_digit = [](char letter) { return letter >= '0' && letter <= '9'; };
  while (!left.empty() && !right.empty()) {
    if (!is_digit(left.front()) || !is_digit(right.front())) {
      if (left.front() != right.front()) return left.front() < right.front();
      left.remove_prefix(1);
      right.remove_prefix(1);
      continue;
    }
    const auto take_number = [&](std::string_view& text) {
      const auto* const end = std::find_if_not(text.begin(), text.end(), is_digit);
      const auto length = static_cast<std::size_t>(end - text.begin());
      const auto number = parse_number<std::uint64_t>(text.substr(0, length)).value_or(0);
      text.remove_prefix(length);
      return number;
    };
    const std::uint64_t left_number = take_number(left), right_number = take_number(right);
    if (left_number != right_number) return left_number < right_number;
  }
  return left.size() < right.size();
}

std::vector<Model> read_folder(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw UsageError("there is no folder " + folder.string());
  }
  std::vector<Model> models;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".dot") models.push_back(read(entry.path()));
  }
  std::sort(models.begin(), models.end(), [](const Model& left, const Model& right) {
    if (left.system != right.system) return left.system < right.system;
    return is_earlier(left.version, right.version);
  });
  if (models.empty()) throw UsageError("no .dot files in " + folder.string());
  return models;
}

using Costs = std::map<std::string, std::pair<Cost, Cost>>;  // by algorithm: without, with

// A line: symbols + resets (equivalence queries) without and with the old model, by algorithm.
void print(const std::string& name, const Costs& costs) {
  fmt::print("{:<48}", name);
  for (const auto& [algorithm, pair] : costs) {
    const auto& [without, with] = pair;
    fmt::print("  {:>9} ({:>3}) {:>9} ({:>3}) {:>5.2f}{}", without.queries,
               without.equivalence_queries, with.queries, with.equivalence_queries,
               static_cast<double>(with.queries) / static_cast<double>(without.queries),
               without.is_right && with.is_right ? "" : " WRONG");
  }
  fmt::print("\n");
}

Costs compare(const Mealy& machine, const Mealy& old_model,
              std::span<const LearnerEntry* const> algorithms) {
  Costs costs;
  for (const LearnerEntry* entry : algorithms) {
    costs[std::string(entry->name)] = {measure(*entry, machine, nullptr),
                                       measure(*entry, machine, &old_model)};
  }
  return costs;
}

void add(Costs& sum, const Costs& costs) {
  for (const auto& [algorithm, pair] : costs) {
    sum[algorithm].first += pair.first;
    sum[algorithm].second += pair.second;
  }
}

bool run_versions(const std::vector<Model>& models,
                  std::span<const LearnerEntry* const> algorithms) {
  Costs sum;
  for (std::size_t i = 1; i < models.size(); ++i) {
    const Model &before = models[i - 1], &now = models[i];
    if (before.system != now.system || before.version.empty()) continue;
    const Costs costs = compare(now.machine, before.machine, algorithms);
    print(fmt::format("{} {} -> {}, {}x{}", now.system, before.version, now.version,
                      now.machine.size(), now.machine.inputs().size()),
          costs);
    add(sum, costs);
  }
  print("all versions", sum);
  return std::all_of(sum.begin(), sum.end(), [](const auto& entry) {
    return entry.second.first.is_right && entry.second.second.is_right;
  });
}

bool run_mutants(const std::vector<Model>& models, std::uint64_t mutants,
                 std::span<const LearnerEntry* const> algorithms) {
  bool all_right = true;
  for (const std::size_t changes : {0, 1, 2, 4, 16}) {
    Costs sum;
    for (const Model& model : models) {
      Random random(changes + 1);
      for (std::uint64_t mutant = 0; mutant < mutants; ++mutant) {
        const Mealy next = minimize(mutate(model.machine, changes, random));
        add(sum, compare(next, model.machine, algorithms));
      }
    }
    print(fmt::format("{} mutants of each model, {} changes", mutants, changes), sum);
    for (const auto& [algorithm, pair] : sum) {
      all_right = all_right && pair.first.is_right && pair.second.is_right;
    }
  }
  return all_right;
}

int run_all(std::span<char*> arguments) {
  if (arguments.size() != 2 &&
      (arguments.size() != 4 || arguments[2] != std::string("--mutants"))) {
    throw UsageError("usage: bench_adaptive FOLDER [--mutants N]");
  }
  const std::vector<Model> models = read_folder(arguments[1]);
  std::vector<const LearnerEntry*> algorithms;
  for (const char* name : {"lsharp", "lsharp-sepseq", "op", "rs"}) {
    algorithms.push_back(&find_deterministic_learner(name));
  }
  fmt::print("{:<48}", "symbols + resets (equivalence queries), from");
  for (const auto& [name, cost] :
       compare(models.front().machine, models.front().machine, algorithms)) {
    fmt::print("  {:<36}", name + ": nothing, old model, ratio");
  }
  fmt::print("\n");
  bool all_right = run_versions(models, algorithms);
  if (arguments.size() == 4) {
    const auto mutants = parse_number<std::uint64_t>(arguments[3]);
    if (!mutants) throw UsageError("not a number of mutants: " + std::string(arguments[3]));
    all_right = run_mutants(models, *mutants, algorithms) && all_right;
  }
  return all_right ? 0 : 1;
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  try {
    return maide::run_all({argv, static_cast<std::size_t>(argc)});
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_adaptive: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
