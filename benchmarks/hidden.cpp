// How often the default tests find all of a machine that hides something, and whether they say so
// where they do not.
//
//   bench_hidden [--classes NAME,...] [--machines N] [--first N] [--states N] [--inputs N] [--seeds
//   N]
//                [--seed S] [--eq NAME] [--limit SECONDS] [--write FOLDER] [--quiet] [MODEL ...]
//
// N machines of each class (automata/random_automata.hpp), of up to so many states and inputs; or
// the MODELs instead. Each is learned with L#, the method and each
// seed, in memory. A line a run: states found of all, whether the model is right, weak, or wrong
// and not called weak (SILENT), what was missing, words and symbols that reached the machine, and
// processor time. A run that takes longer than the limit is interrupted, and counted as such: it
// says itself that it was not finished. Then a line a class. Exit status 1 if a run was silent.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

struct Arguments {
  std::vector<std::string> classes;
  std::vector<std::string> models;
  std::size_t machines = 10, first = 0, states = 300, inputs = 100;
  std::uint64_t seed = 1, seeds = 1;
  std::string method, folder;
  double limit = 60;
  bool is_quiet = false;
};

struct Counts {
  std::size_t runs = 0, right = 0, weak_and_right = 0, weak_and_wrong = 0, silent = 0,
              unfinished = 0;
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Stops a run that has taken too much processor time.
class CpuLimit : public ProgressObserver {
 public:
  explicit CpuLimit(double seconds) : end_(cpu_seconds() + seconds) {}
  void on_progress(const Progress&) override {
    if (cpu_seconds() > end_) stop_.request_stop();
  }
  std::stop_token token() const { return stop_.get_token(); }

 private:
  double end_;
  std::stop_source stop_;
};

void learn_once(const std::string& name, const Mealy& machine, std::uint64_t seed,
                const Arguments& arguments, Counts& counts) {
  MealyOracle system(machine);
  CountingOracle counter(system);
  Cache cache(counter);
  TestMethodOptions options;
  options.seed = seed;
  const auto tests = TestChain(arguments.method).make({cache, &cache, &machine}, options);
  const auto learner = find_deterministic_learner("lsharp").make(cache);
  const double start = cpu_seconds();
  CpuLimit limit(arguments.limit);
  RunControl control;
  control.stop = limit.token();
  control.progress = &limit;
  std::uint64_t equivalence_queries = 0;
  bool is_finished = true;
  try {
    run_learner(*learner, *tests, control,
                [&](const Mealy&, std::uint64_t round) { equivalence_queries = round; });
  } catch (const Interrupted&) {
    is_finished = false;
  }
  const Mealy& found = learner->hypothesis();
  const bool is_right = found.size() > 0 && !find_difference(found, machine);
  const std::string shortfall =
      describe_shortfall(tests->strength(), default_demand(found.size(), found.inputs().size(), 0));
  const bool is_silent = is_finished && !is_right && shortfall.empty();
  ++counts.runs;
  if (!is_finished) {
    ++counts.unfinished;
  } else if (is_right) {
    ++(shortfall.empty() ? counts.right : counts.weak_and_right);
  } else {
    ++(shortfall.empty() ? counts.silent : counts.weak_and_wrong);
  }
  if (arguments.is_quiet && !is_silent) return;
  const Statistics& statistics = counter.statistics();
  fmt::print(
      "{:<34} {:>4} x {:<3} {:>4} found {} {} words {:>9} symbols {:>9} eq {:>3} cpu {:>6.2f}  "
      "{}\n",
      name, machine.size(), machine.inputs().size(), found.size(), seed,
      !is_finished ? "UNFINISHED"
      : is_silent  ? "SILENT"
      : is_right   ? "right"
                   : "wrong",
      statistics.total().queries, statistics.total().symbols, equivalence_queries,
      cpu_seconds() - start, shortfall);
  std::fflush(stdout);
}

// From 4 on; its logarithm is uniform, as small machines are more frequent than large ones.
std::size_t draw_size(std::size_t most, Random& random) {
  const double size = 4 * std::pow(static_cast<double>(most) / 4, random.unit());
  return std::clamp(static_cast<std::size_t>(std::lround(size)), std::size_t{4}, most);
}

// An interface automaton is learned as its eager translation.
Mealy read_machine(const std::string& path) {
  const Model model = read_model(path);
  if (const auto* automaton = std::get_if<InterfaceAutomaton>(&model)) {
    return to_mealy(*automaton, Translation::eager);
  }
  return read_mealy(path);
}

int run_all(const Arguments& arguments) {
  std::map<std::string, Counts> table;
  for (const std::string& path : arguments.models) {
    const Mealy machine = read_machine(path);
    const std::string name = std::filesystem::path(path).stem().string();
    for (std::uint64_t seed = 0; seed < arguments.seeds; ++seed) {
      learn_once(name, machine, arguments.seed + seed, arguments, table["models"]);
    }
  }
  for (const std::string& name : arguments.classes) {
    if (!arguments.models.empty()) break;
    Random random = Random(arguments.seed + 1000 * static_cast<std::uint64_t>(find_hiding(name)));
    for (std::size_t i = 0; i < arguments.machines; ++i) {
      Random own = random.split();
      const std::size_t states = draw_size(arguments.states, own);
      const std::size_t inputs = draw_size(arguments.inputs, own);
      if (i < arguments.first) continue;
      const Mealy machine = hiding_mealy(find_hiding(name), states, inputs, own);
      if (!arguments.folder.empty()) {
        std::ofstream file(std::filesystem::path(arguments.folder) /
                           fmt::format("{}-{}.dot", name, i));
        write_dot(file, machine);
        if (!file.flush()) throw UsageError(fmt::format("cannot write to {}", arguments.folder));
      }
      for (std::uint64_t seed = 0; seed < arguments.seeds; ++seed) {
        learn_once(fmt::format("{} {}", name, i), machine, arguments.seed + seed, arguments,
                   table[name]);
      }
    }
  }
  fmt::print("\n{:<10} {:>6} {:>6} {:>11} {:>11} {:>11} {:>7}\n", "", "runs", "right",
             "right, weak", "wrong, weak", "unfinished", "silent");
  bool is_any_silent = false;
  for (const auto& [name, counts] : table) {
    fmt::print("{:<10} {:>6} {:>6} {:>11} {:>11} {:>11} {:>7}\n", name, counts.runs, counts.right,
               counts.weak_and_right, counts.weak_and_wrong, counts.unfinished, counts.silent);
    is_any_silent = is_any_silent || counts.silent > 0;
  }
  return is_any_silent ? 1 : 0;
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  CLI::App app("How often the default tests find all of a machine that hides something");
  maide::Arguments arguments;
  arguments.classes.assign(maide::hiding_names().begin(), maide::hiding_names().end());
  app.add_option("--classes", arguments.classes, "How the machines hide something")->delimiter(',');
  app.add_option("MODEL", arguments.models, "Machines to learn instead");
  app.add_option("--machines", arguments.machines, "Machines of each class");
  app.add_option("--first", arguments.first, "The first of them that is learned");
  app.add_option("--states", arguments.states, "Most states")->check(CLI::Range(4, 100000));
  app.add_option("--inputs", arguments.inputs, "Most inputs")->check(CLI::Range(4, 1000));
  app.add_option("--seed", arguments.seed, "Of machines and tests");
  app.add_option("--seeds", arguments.seeds, "Runs a machine");
  app.add_option("--eq", arguments.method, "The equivalence method");
  app.add_option("--write", arguments.folder, "A folder for the machines, as DOT")
      ->check(CLI::ExistingDirectory);
  app.add_option("--limit", arguments.limit, "Most seconds of processor time of a run");
  app.add_flag("--quiet", arguments.is_quiet, "Only silent runs, and the table");
  CLI11_PARSE(app, argc, argv);
  try {
    return maide::run_all(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_hidden: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
