// Oracles that watch what passes. `ObservingOracle` keeps all answers in an observation tree.
// `CountingOracle` counts queries, symbols and times, and `PhasedTeacher` tells it which of them
// belong to equivalence queries.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/learn/lsharp/observation_tree.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/oracle/statistics.hpp"

namespace maide {

// Keeps all answers in an observation tree. A learner on top of it asks nothing twice, and finds in
// the tree what tells states apart.
class ObservingOracle : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  explicit ObservingOracle(OutputOracle& system)
      : OracleDecorator(system), tree_(system.inputs().size()) {}

  const ObservationTree& tree() const { return tree_; }
  std::uint64_t output_queries() const { return output_queries_; }  // that reached the system

  using OutputOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

 private:
  bool look_up(const Query& query, MealyAnswer& answer) const;
  void keep(const MealyAnswer& answer);

  ObservationTree tree_;
  std::uint64_t output_queries_ = 0;
};

// The error for an answer that contradicts the tree at its symbol `place`, as insert() found out.
NondeterminismError contradiction(const ObservationTree& tree, const MealyAnswer& answer,
                                  std::size_t place, const OutputOracle& oracle);

// Counts what passes: put it below the cache to count what reaches the system, above it to count
// what is asked. PhasedTeacher tells it which queries belong to equivalence tests.
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
