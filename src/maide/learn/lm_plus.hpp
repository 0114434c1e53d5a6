// L*M+ (Shahbaz, PhD thesis, Grenoble 2008; Shahbaz & Groz, "Inferring Mealy Machines", FM 2009):
// an observation table that begins with the single inputs as columns and whose counterexamples
// become suffixes. A counterexample u v, u its longest prefix that is a row, gives all non-empty
// suffixes of v.
//
// Invariant: E is suffix-closed, so the hypothesis agrees with the table and no word is a
// counterexample twice. For n states, k inputs and counterexamples of length m: at most
// (n k + 1) (k + (n - 1) m) + n output queries, at most n - 1 counterexamples.
#pragma once

#include "maide/learn/table_learner.hpp"

namespace maide {

class LmPlus : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit LmPlus(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::inputs) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

}  // namespace maide
