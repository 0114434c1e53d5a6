// The observation table with Rivest & Schapire's handling of counterexamples ("Inference of finite
// automata using homing sequences", Information and Computation 103, 1993): binary search finds the
// one suffix of the counterexample that splits a state, and only that becomes a column. There are
// no columns at first, so each is there for a reason.
//
// E is not suffix-closed, so a hypothesis may contradict its own table: the same counterexample is
// handled again until the hypothesis agrees with it. For n states, k inputs and counterexamples of
// length m: at most n k + (n k + 1) (n - 1) + (n - 1) (1 + ceil(log2 m)) output queries.
#pragma once

#include "maide/learn/table_learner.hpp"

namespace maide {

class RivestSchapire : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit RivestSchapire(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::none) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

}  // namespace maide
