// The equivalence oracle that knows the answer: compares with a reference machine and sends nothing
// to the system. For simulated systems, tests and benchmarks.
#pragma once

#include "maide/conformance/incremental_comparison.hpp"
#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

class PerfectOracle : public EquivalenceOracle {
 public:
  // Keeps a reference to `reference`, which must be complete.
  explicit PerfectOracle(const Mealy& reference) : comparison_(reference) {}

  // A shortest counterexample, alphabet-least. Throws UsageError if the inputs differ.
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;
  Strength strength() const override { return {.exact = true}; }

 private:
  IncrementalComparison comparison_;
};

}  // namespace maide
