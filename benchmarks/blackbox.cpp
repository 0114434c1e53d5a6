// Learning without a perfect oracle: how often the equivalence tests find all of a machine, and how
// many inputs they take for it.
//
//   bench_blackbox [--eq NAME] [--algorithm NAME] [--seeds N] FOLDER [MODEL ...]
//
// FOLDER holds Mealy machines as .dot files; without MODELs those with published figures are taken:
// OpenSSH, TCP_Linux_Server, BitVise, DropBear. The tests' inputs are counted before the cache, up
// to and with the last counterexample (as published: what it takes until the last state is found),
// and in all. Exit status 1 if a machine was not learned completely for every seed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

// Randomised hybrid ADS, mean of 100 seeds, of the papers on L#.
struct Published {
  std::string_view model;
  std::string_view symbols;
};
constexpr Published published[] = {
    {"OpenSSH", "2.3M"}, {"TCP_Linux_Server", "0.93M"}, {"BitVise", "2.3M"}, {"DropBear", "25k"}};

struct Arguments {
  std::string folder;
  std::vector<std::string> models;
  std::string method{test_methods().front().name};
  std::string algorithm{learners().front().name};
  std::uint64_t seeds = 20;
};

struct Run {
  std::uint64_t until_last = 0;  // test inputs, up to and with the last counterexample
  std::uint64_t total = 0;       // with those that found nothing more
  std::size_t states = 0;
  bool is_complete = false;
};

// Remembers what was counted when the last counterexample was found.
class LastCounterexample : public EquivalenceOracle {
 public:
  LastCounterexample(EquivalenceOracle& teacher, const CountingOracle& counter)
      : teacher_(teacher), counter_(counter) {}
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control) override {
    auto word = teacher_.find_counterexample(hypothesis, control);
    if (word) symbols = counter_.statistics().total().symbols;
    return word;
  }
  std::string guarantee() const override { return teacher_.guarantee(); }
  std::uint64_t symbols = 0;

 private:
  EquivalenceOracle& teacher_;
  const CountingOracle& counter_;
};

Run learn_once(const Mealy& model, const Arguments& arguments, std::uint64_t seed) {
  MealyOracle system(model);
  Cache cache(system);
  CountingOracle tests(cache);
  TestMethodOptions options;
  options.seed = seed;
  const auto method = TestChain(arguments.method).make({tests, &cache, &model}, options);
  LastCounterexample teacher(*method, tests);
  const auto learner = find_deterministic_learner(arguments.algorithm).make(cache);
  const LearnResult result = run_learner(*learner, teacher);
  return {teacher.symbols, tests.statistics().total().symbols, result.model.size(),
          !find_difference(result.model, model)};
}

// One line of the table; false if a seed did not find everything.
bool measure(const std::filesystem::path& path, const Arguments& arguments) {
  const Mealy model = read_mealy(path);
  const std::string name = path.stem().string();
  const std::clock_t start = std::clock();
  std::uint64_t complete = 0, sum_until = 0, most_until = 0, sum_total = 0;
  std::size_t fewest_states = model.size();
  for (std::uint64_t seed = 1; seed <= arguments.seeds; ++seed) {
    const Run run = learn_once(model, arguments, seed);
    complete += run.is_complete ? 1 : 0;
    sum_until += run.until_last;
    most_until = std::max(most_until, run.until_last);
    sum_total += run.total;
    fewest_states = std::min(fewest_states, run.states);
  }
  const auto entry = std::find_if(std::begin(published), std::end(published),
                                  [&](const Published& known) { return known.model == name; });
  fmt::print("{:<20} {:>4} x {:<3} {:>4} of {:<4} {:>5} {:>10} {:>10} {:>10} {:>10} {:>8.2f}\n",
             name, model.size(), model.inputs().size(), complete, arguments.seeds, fewest_states,
             sum_until / arguments.seeds, most_until, sum_total / arguments.seeds,
             entry == std::end(published) ? "" : entry->symbols,
             static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC /
                 static_cast<double>(arguments.seeds));
  std::fflush(stdout);
  return complete == arguments.seeds;
}

int run_all(Arguments arguments) {
  if (arguments.models.empty()) {
    for (const Published& entry : published) arguments.models.emplace_back(entry.model);
  }
  fmt::print("{}, {}; inputs of tests: until the last state was found, and in all\n\n",
             arguments.algorithm, arguments.method);
  fmt::print("{:<20} {:>10} {:>12} {:>5} {:>10} {:>10} {:>10} {:>10} {:>8}\n", "model", "states",
             "complete", "least", "mean", "most", "in all", "published", "CPU s");
  bool all = true;
  for (const std::string& model : arguments.models) {
    all = measure(std::filesystem::path(arguments.folder) / (model + ".dot"), arguments) && all;
  }
  return all ? 0 : 1;
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  CLI::App app("How many inputs the equivalence tests need until all of a machine is learned");
  maide::Arguments arguments;
  app.add_option("FOLDER", arguments.folder, "Where the models are")->required();
  app.add_option("MODEL", arguments.models, "Their names, without .dot");
  app.add_option("--eq", arguments.method, "The equivalence method");
  app.add_option("--algorithm", arguments.algorithm, "The learner");
  app.add_option("--seeds", arguments.seeds, "Runs a model")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    return maide::run_all(std::move(arguments));
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_blackbox: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
