// The observation pack (Howar, "Active Learning of Interface Programs", PhD thesis, Dortmund 2012)
// on a discrimination tree: each state is asked only the suffixes that tell it from others. A
// counterexample is decomposed by binary search (Rivest & Schapire 1993) and splits one leaf by one
// suffix.
//
// Suffixes are not closed, so the hypothesis may still be wrong about the counterexample: it is
// handled again until they agree. For n states, k inputs and counterexamples of length m: at most
// k n^2 + k n + (n - 1) (3 + ceil(log2 m)) output queries, at most n - 1 counterexamples.
#pragma once

#include <vector>

#include "maide/learn/discrimination_tree.hpp"
#include "maide/learn/learner.hpp"

namespace maide {

class ObservationPack : public Learner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit ObservationPack(OutputOracle& oracle) : oracle_(oracle), tree_(oracle) {}

  void start(const RunControl& control = {}) override;
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return hypothesis_; }
  std::uint64_t output_queries() const override {
    return tree_.output_queries() + counterexample_queries_;
  }

 private:
  void make_hypothesis();

  OutputOracle& oracle_;
  DiscriminationTree tree_;
  Mealy hypothesis_;
  std::vector<StateId> tree_state_;  // of each state of the hypothesis
  std::vector<Word> access_;         // of each state of the hypothesis
  std::uint64_t counterexample_queries_ = 0;
};

}  // namespace maide
