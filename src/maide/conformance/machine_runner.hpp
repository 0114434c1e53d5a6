// Runs test suites against a machine in memory, as fast as it can be done: tests are made and
// played one by one, nothing is kept, no oracle is asked. For measurements on large models, where
// some 10^9 inputs are played: a TestRunner keeps answers, and a cache all words.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/conformance/test_suite.hpp"

namespace maide {

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
