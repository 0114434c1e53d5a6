// L*M, Angluin's L* for Mealy machines (Angluin, "Learning regular sets from queries and
// counterexamples", Information and Computation 75, 1987; Niese, PhD thesis, Dortmund 2003): an
// observation table that begins with the single inputs as columns, and whose counterexamples become
// rows. All prefixes of a counterexample are made short rows; where two equal ones have different
// extensions, a suffix tells them apart.
//
// Invariant: E is suffix-closed, so the hypothesis agrees with a closed and consistent table. For n
// states, k inputs and counterexamples of length m: at most
// ((n + (n - 1) m) k + 1) (k + n - 1) + n output queries, at most n - 1 counterexamples.
#pragma once

#include "maide/learn/table_learner.hpp"

namespace maide {

class LStar : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit LStar(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::inputs) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

}  // namespace maide
