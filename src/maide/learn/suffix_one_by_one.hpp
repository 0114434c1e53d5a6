// Suffix1by1 (Irfan, Oriat & Groz, "Angluin style finite state machine inference with non-optimal
// counterexamples", MIIT 2010): an observation table that begins with the single inputs as columns.
// The suffixes of a counterexample become columns in the order of their length, one at a time, and
// only until the table shows a new state: a long counterexample costs no more than it must.
//
// Invariant: E is suffix-closed, so the hypothesis agrees with the table. The bounds are those of
// L*M+ (lm_plus.hpp).
#pragma once

#include "maide/learn/table_learner.hpp"

namespace maide {

class SuffixOneByOne : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit SuffixOneByOne(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::inputs) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

}  // namespace maide
