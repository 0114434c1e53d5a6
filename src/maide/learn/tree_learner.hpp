// What learners with a discrimination tree share; they differ in how a counterexample splits the
// tree. A counterexample costs one output query, which a cache that saw the equivalence test
// answers, and is handled until the hypothesis agrees with it.
#pragma once

#include "maide/learn/learner.hpp"
#include "maide/learn/tree_hypothesis.hpp"

namespace maide {

class TreeLearner : public Learner {
 public:
  void start(const RunControl& control = {}) override { complete(control); }
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return states_.machine(); }
  std::uint64_t output_queries() const override {
    return states_.output_queries() + counterexample_queries_;
  }

 protected:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit TreeLearner(OutputOracle& oracle) : oracle_(oracle), states_(oracle) {}

  // Called once for each counterexample, when it has split the tree: it may still be one.
  virtual void restructure(const RunControl& /*control*/) {}

  // Splits the tree. `counterexample` is cut at its first mismatch; `outputs` is what the system
  // answers to it, or more. Returns false if there was nothing to split: then the system answers
  // now one way, now another.
  virtual bool split(const Word& counterexample, std::span<const Symbol> outputs,
                     const RunControl& control) = 0;

  // Splits the tree where the hypothesis first differs from what the system answers to `word`;
  // returns false if it agrees. Afterwards complete(). Throws NondeterminismError if there was
  // nothing to split.
  bool split_at_mismatch(const Word& word, const Word& outputs, const RunControl& control);

  // Sifts what a split left and makes the hypothesis.
  virtual void complete(const RunControl& control);

  // Decomposes a word on which the machine differs from the system after its last input, and splits
  // the leaf that its transition leads to by the suffix that is found.
  bool split_by_suffix(std::span<const StateId> states, const Word& word, Symbol last_output,
                       bool temporary, const RunControl& control);

  OutputOracle& oracle_;
  TreeHypothesis states_;
  std::uint64_t counterexample_queries_ = 0;  // output queries to analyse counterexamples
};

}  // namespace maide
