// Kearns & Vazirani's learner ("An Introduction to Computational Learning Theory", 1994, chapter 8)
// for Mealy machines. It looks for the place in a counterexample where the hypothesis goes astray:
// the prefix up to there is sifted to the hypothesis' state, the next one is not. Binary search
// finds one (Rivest & Schapire, Information and Computation 103, 1993). What tells the second
// prefix from its state is a suffix x that the tree has already, so a x, for the input a between
// them, tells the first prefix from its state; the counterexample's own suffixes are never used.
//
// The leaf gets the suffix a x. A transition that answers otherwise than the state is a new one; if
// there is none yet, the first prefix is sifted nowhere from now on, and the next place is an
// earlier one. So access words stay prefix-closed, and discriminators grow by an input at a time.
//
// For n states, k inputs and counterexamples of length m: at most k n^2 + k n +
// (n - 1) (n - 1) ceil(log2 m) + n output queries, at most n - 1 counterexamples.
#pragma once

#include "maide/learn/tree_learner.hpp"

namespace maide {

class KearnsVazirani : public TreeLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit KearnsVazirani(OutputOracle& oracle) : TreeLearner(oracle) {}

 private:
  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
};

}  // namespace maide
