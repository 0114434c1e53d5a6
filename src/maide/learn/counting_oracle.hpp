// Counts what passes: put it below the cache to count what reaches the system, above it to count
// what is asked. PhasedTeacher tells it which queries belong to equivalence tests.
#pragma once

#include "maide/learn/equivalence_oracle.hpp"
#include "maide/learn/oracle_decorator.hpp"
#include "maide/learn/statistics.hpp"

namespace maide {

class CountingOracle : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  explicit CountingOracle(OutputOracle& system) : OracleDecorator(system) {}

  using OutputOracle::ask;
  // Queries of a batch that ends early are counted if they were answered.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

  LearnPhase phase() const { return phase_; }
  // Later queries count for this phase.
  void set_phase(LearnPhase phase) { phase_ = phase; }
  const Statistics& statistics() const { return statistics_; }

 private:
  void count(const MealyAnswer& answer);

  LearnPhase phase_ = LearnPhase::learning;
  Statistics statistics_;
};

// Passes equivalence queries on; meanwhile the counter is in phase `testing`, and afterwards in
// phase `refinement`.
class PhasedTeacher : public EquivalenceOracle {
 public:
  // Keeps both references.
  PhasedTeacher(EquivalenceOracle& teacher, CountingOracle& counter)
      : teacher_(teacher), counter_(counter) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override { return teacher_.guarantee(); }
  Strength strength() const override { return teacher_.strength(); }
  TestCost cost_of_missing() const override { return teacher_.cost_of_missing(); }

 private:
  EquivalenceOracle& teacher_;
  CountingOracle& counter_;
};

}  // namespace maide
