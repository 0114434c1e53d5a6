// Runs test suites. `TestRunner` runs them on a system, in batches, in the order of the suite, up
// to the first test that tells hypothesis and system apart. The whole batch is answered and then
// looked through in order, so the result does not depend on what runs in parallel below the output
// oracle. `SuiteMethod` makes an equivalence oracle of that. `MachineRunner` runs suites on a
// machine in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/conformance/suite/test_suite.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

struct TestRunnerOptions {
  std::uint64_t max_tests = std::numeric_limits<std::uint64_t>::max();  // in one suite
  std::size_t batch_size = 64;  // tests in flight; those behind a counterexample are wasted
  std::uint64_t max_symbols =
      std::numeric_limits<std::uint64_t>::max();  // ends at the test that reaches it
  std::string_view phase = "testing";             // as progress says it
  bool whole_words = false;  // what follows the first difference in a test is given back, too
};

// Runs test suites on the system below an output oracle.
class TestRunner {
 public:
  // Keeps a reference to `oracle`.
  TestRunner(OutputOracle& oracle, TestRunnerOptions options)
      : oracle_(oracle), options_(options) {}

  // The first test on which they differ, cut at the first output that does unless whole words are
  // wanted; nothing if all pass.
  // Throws UsageError if the hypothesis has other inputs than the system, Interrupted, and what the
  // oracle throws. One output query a test.
  std::optional<Word> run(TestSuite& suite, const Mealy& hypothesis, const RunControl& control);

  std::uint64_t max_tests() const { return options_.max_tests; }
  // Tests of the last run, up to and with the counterexample.
  std::uint64_t last_tests() const { return last_tests_; }
  // Their inputs.
  std::uint64_t last_symbols() const { return last_symbols_; }
  // The last run came to the end of its suite (not to a limit, nor to a counterexample).
  bool last_was_complete() const { return last_was_complete_; }

 private:
  OutputOracle& oracle_;
  TestRunnerOptions options_;
  std::uint64_t last_tests_ = 0, last_symbols_ = 0;
  bool last_was_complete_ = false;
};

// An equivalence oracle that runs one suite for each hypothesis. A class that derives from it makes
// the suite, and says what its tests establish.
class SuiteMethod : public EquivalenceOracle {
 public:
  std::string guarantee() const override { return guarantee_; }
  Strength strength() const override { return strength_; }

 protected:
  // What tests establish that found nothing.
  struct Passed {
    std::string guarantee;
    Strength strength = {};
  };

  // Keeps a reference to `oracle`.
  SuiteMethod(OutputOracle& oracle, TestRunnerOptions options) : runner_(oracle, options) {}

  // As TestRunner::run(). `refuter` is what found a counterexample, if there is one: "a random
  // walk". Otherwise `passed` is called with the number of tests.
  std::optional<Word> run(TestSuite& suite, const Mealy& hypothesis, const RunControl& control,
                          std::string_view refuter,
                          const std::function<Passed(std::uint64_t tests)>& passed);

 private:
  TestRunner runner_;
  std::string guarantee_ = "not tested";
  Strength strength_;
};

// Runs test suites on a machine in memory, as fast as possible: tests are made and played one by
// one, nothing is kept, no oracle is asked. For measurements on large models, where some 10^9
// inputs are played.
class MachineRunner {
 public:
  // `system` must be complete; it is copied.
  explicit MachineRunner(const Mealy& system);

  // The first test on which they differ, cut at the first output that does; nothing if all pass, or
  // the first that are played with `max_symbols` inputs. Throws UsageError if the hypothesis has
  // other inputs than the system, Interrupted.
  std::optional<Word> run(TestSuite& suite, const Mealy& hypothesis, std::uint64_t max_symbols,
                          const RunControl& control = {});

  // Of all runs.
  std::uint64_t tests() const { return tests_; }
  std::uint64_t symbols() const { return symbols_; }

 private:
  Alphabet inputs_, outputs_;
  // Where a transition leads, as the index of the state's first transition, and what it answers.
  struct Step {
    std::uint32_t target, output;
  };
  static std::vector<Step> flatten(const Mealy& machine, const std::vector<Symbol>& outputs);

  std::vector<Step> system_;
  std::uint32_t initial_;
  std::uint64_t tests_ = 0, symbols_ = 0;
};

}  // namespace maide
