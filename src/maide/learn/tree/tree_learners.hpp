// Learners with a discrimination tree: what they all share (`TreeLearner`), Kearns & Vazirani's,
// and the observation pack. TTT and ADT have files of their own. They differ in how a
// counterexample splits the tree.
#pragma once

#include "maide/learn/learner.hpp"
#include "maide/learn/tree/tree_hypothesis.hpp"

namespace maide {

// What they share. A counterexample costs one output query, which a cache that saw the equivalence
// test answers. It is handled until the hypothesis agrees with it.
class TreeLearner : public Learner {
 public:
  void start(const RunControl& control = {}) override { complete(control); }
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return states_.machine(); }
  std::uint64_t output_queries() const override {
    return states_.output_queries() + counterexample_queries_;
  }
  void check_invariants() const override;

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

  // Decomposes a word whose last input the machine and the system answer differently. Splits the
  // leaf that its transition leads to by the suffix that is found.
  bool split_by_suffix(std::span<const StateId> states, const Word& word, Symbol last_output,
                       bool temporary, const RunControl& control);

  OutputOracle& oracle_;
  TreeHypothesis states_;
  std::uint64_t counterexample_queries_ = 0;  // output queries to analyse counterexamples
};

// Kearns & Vazirani's learner ("An Introduction to Computational Learning Theory", 1994, chapter 8)
// for Mealy machines. It looks for the place in a counterexample where the hypothesis goes astray:
// the prefix up to there is sifted to the hypothesis' state, and the prefix that is longer by one
// input a is not. Binary search finds such a place (Rivest & Schapire, Information and Computation
// 103, 1993). A suffix x in the tree tells the longer prefix from its state. So a x tells the
// shorter prefix from its state, and becomes the suffix of the leaf. The counterexample's own
// suffixes are never used.
//
// A transition that answers otherwise than the state becomes a new state. If there is none yet, the
// shorter prefix is sifted nowhere from then on, and the next place is an earlier one. So access
// words stay prefix-closed, and discriminators grow by one input at a time.
//
// For n states, k inputs and counterexamples of length m: at most k n^2 + k n + (n - 1) (n - 1)
// ceil(log2 m) + n output queries, at most n - 1 counterexamples.
class KearnsVazirani : public TreeLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit KearnsVazirani(OutputOracle& oracle) : TreeLearner(oracle) {}

 private:
  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
};

// The observation pack (Howar, "Active Learning of Interface Programs", PhD thesis, Dortmund 2012)
// on a discrimination tree. A state is asked only the suffixes that tell it from others. A
// counterexample is decomposed by binary search (Rivest & Schapire 1993) and splits one leaf by one
// suffix.
//
// Suffixes are not closed, so the hypothesis may still be wrong about the counterexample. The
// counterexample is handled again until they agree. For n states, k inputs and counterexamples of
// length m: at most k n^2 + k n + (n - 1) (3 + ceil(log2 m)) output queries, at most n - 1
// counterexamples.
class ObservationPack : public TreeLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit ObservationPack(OutputOracle& oracle) : TreeLearner(oracle) {}

 private:
  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
};

}  // namespace maide
