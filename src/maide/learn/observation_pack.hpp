// The observation pack (Howar, "Active Learning of Interface Programs", PhD thesis, Dortmund 2012)
// on a discrimination tree: each state is asked only the suffixes that tell it from others. A
// counterexample is decomposed by binary search (Rivest & Schapire 1993) and splits one leaf by one
// suffix.
//
// Suffixes are not closed, so the hypothesis may still be wrong about the counterexample: it is
// handled again until they agree. For n states, k inputs and counterexamples of length m: at most
// k n^2 + k n + (n - 1) (3 + ceil(log2 m)) output queries, at most n - 1 counterexamples.
#pragma once

#include "maide/learn/tree_learner.hpp"

namespace maide {

class ObservationPack : public TreeLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit ObservationPack(OutputOracle& oracle) : TreeLearner(oracle) {}

 private:
  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
};

}  // namespace maide
