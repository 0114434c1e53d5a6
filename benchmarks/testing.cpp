// How fast conformance tests are made and played on a machine in memory, on one core; and with what
// that can be done, how much of a machine is learned without a perfect oracle.
//
//   bench_testing [--symbols N] [--learn] [--seed S] [--infix-mean M] MODEL.dot ...
//
// For each model and each method of random tests: the tests of the model against itself, N inputs.
// --learn instead learns each model with random tests of hybrid ADS, until N inputs in a row find
// nothing more, and says after each tenth of the states what it has cost. Exit status 1 if a model
// is not learned completely.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "cpu_seconds.hpp"
#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/random_identifier_suite.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "test_speed.hpp"

namespace maide::bench {
namespace {

struct Arguments {
  std::vector<std::string> models;
  double symbols = 2e8;
  bool learn = false;
  std::uint64_t seed = 1;
  double infix_mean = InfixLaw{}.mean;
  std::string algorithm = "rs";
};

void measure_speed(const std::string& name, const Mealy& model, const Arguments& arguments) {
  for (const IdentifierMethod& method :
       {w_identifiers, wp_identifiers, hsi_identifiers, hads_identifiers}) {
    const TestSpeed speed =
        measure_tests(model, method, {.mean = arguments.infix_mean},
                      static_cast<std::uint64_t>(arguments.symbols), arguments.seed);
    fmt::print("{:<28} {:>5} x {:<3} {:<15} {:>10.3f} {:>14} {:>10.1f} {:>14.3g}\n", name,
               model.size(), model.inputs().size(), method.title, speed.seconds_to_prepare,
               speed.inputs, static_cast<double>(speed.inputs) / static_cast<double>(speed.tests),
               speed.inputs_a_second());
    std::fflush(stdout);
  }
}

// Tests the hypothesis with new random tests each time.
class Teacher : public EquivalenceOracle {
 public:
  Teacher(const Mealy& model, const Arguments& arguments)
      : states_(model.size()),
        runner_(model),
        most_(static_cast<std::uint64_t>(arguments.symbols)),
        law_{.mean = arguments.infix_mean},
        random_(arguments.seed) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control) override {
    RandomIdentifierSuite suite(hypothesis, compute_adaptive_words(hypothesis, random_.split()),
                                law_, random_.split(), counterexamples_);
    auto word = runner_.run(suite, hypothesis, most_, control);
    if (!word || hypothesis.size() * 10 >= states_ * tenths_) {
      fmt::print("  {:>6} states after {:>15} inputs of tests, {:>9.1f} s CPU\n", hypothesis.size(),
                 runner_.symbols(), cpu_seconds());
      std::fflush(stdout);
      tenths_ = hypothesis.size() * 10 / states_ + 1;
    }
    if (word) {
      until_last_ = runner_.symbols();
      counterexamples_.push_back(*word);
    }
    return word;
  }
  std::string guarantee() const override { return "not refuted"; }
  std::uint64_t until_last() const { return until_last_; }

 private:
  std::size_t states_;
  MachineRunner runner_;
  std::uint64_t most_;
  InfixLaw law_;
  Random random_;
  std::vector<Word> counterexamples_;
  std::size_t tenths_ = 1;
  std::uint64_t until_last_ = 0;
};

bool learn(const std::string& name, const Mealy& model, const Arguments& arguments) {
  fmt::print("{}, {} x {}, {}\n", name, model.size(), model.inputs().size(), arguments.algorithm);
  MealyOracle system(model);
  CountingOracle counter(system);
  Teacher teacher(model, arguments);
  const auto learner = find_deterministic_learner(arguments.algorithm).make(counter);
  const LearnResult result = run_learner(*learner, teacher);
  const bool is_complete = !find_difference(result.model, model);
  fmt::print(
      "  {}: {} of {} states, {} inputs of tests until the last was found, {} of the "
      "learner\n",
      is_complete ? "complete" : "not complete", result.model.size(), model.size(),
      teacher.until_last(), counter.statistics().total().symbols);
  return is_complete;
}

int run_all(const Arguments& arguments) {
  if (!arguments.learn) {
    fmt::print("{:<28} {:>11} {:<15} {:>10} {:>14} {:>10} {:>14}\n", "model", "states", "method",
               "prepare, s", "inputs", "a test", "inputs/s");
  }
  bool all = true;
  for (const std::string& path : arguments.models) {
    const Mealy model = read_mealy(path);
    const std::string name = std::filesystem::path(path).stem().string();
    if (arguments.learn) {
      all = learn(name, model, arguments) && all;
    } else {
      measure_speed(name, model, arguments);
    }
  }
  return all ? 0 : 1;
}

}  // namespace
}  // namespace maide::bench

int main(int argc, char** argv) {
  CLI::App app("Speed of conformance tests on machines in memory");
  maide::bench::Arguments arguments;
  app.add_option("MODEL", arguments.models, "Mealy machines, as .dot files")->required();
  app.add_option("--symbols", arguments.symbols, "Inputs to play");
  app.add_flag("--learn", arguments.learn, "Learn the models");
  app.add_option("--algorithm", arguments.algorithm, "With this learner");
  app.add_option("--seed", arguments.seed, "Of the tests");
  app.add_option("--infix-mean", arguments.infix_mean, "As of maide learn");
  CLI11_PARSE(app, argc, argv);
  try {
    return maide::bench::run_all(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_testing: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
