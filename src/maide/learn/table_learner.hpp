// What learners with an observation table share; they differ in the suffixes that they take from a
// counterexample. A counterexample costs one output query, which a cache that saw the equivalence
// test answers, and is handled until the hypothesis agrees with it.
#pragma once

#include <vector>

#include "maide/learn/learner.hpp"
#include "maide/learn/observation_table.hpp"

namespace maide {

class TableLearner : public Learner {
 public:
  void start(const RunControl& control = {}) override;
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return hypothesis_.machine; }
  std::uint64_t output_queries() const override;

 protected:
  // Keeps a reference to `oracle`.
  TableLearner(OutputOracle& oracle, FirstSuffixes first)
      : oracle_(oracle), table_(oracle, first) {}

  // Suffixes that make the table unclosed. `counterexample` is cut at its first mismatch;
  // `last_output` is what the system answers to its last input.
  virtual std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                        const RunControl& control) = 0;

  OutputOracle& oracle_;
  ObservationTable table_;
  ObservationTable::Hypothesis hypothesis_;
  std::uint64_t counterexample_queries_ = 0;  // output queries to analyse counterexamples
};

}  // namespace maide
