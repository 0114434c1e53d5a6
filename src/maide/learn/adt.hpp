// ADT (Frohme, "Active Automata Learning with Adaptive Distinguishing Sequences", FMICS 2019, arXiv
// 1902.01139): a discrimination tree whose nodes hold adaptive experiments, so that many states are
// told apart without a reset between. What was answered is kept in an observation tree: nothing is
// asked twice, and it shows what tells states apart.
//
// A counterexample is decomposed by binary search (Rivest & Schapire) and splits a leaf. Its two
// states are told apart, in this order,
//
//   by a word that is known to do so after the experiment above, which goes on with it;
//   by a distinguishing sequence that the hypothesis has for them after that experiment; meanwhile
//     the transitions to the leaf wait, for they would be asked twice;
//   by the shortest word that is known to do so, a new experiment after a reset.
//
// Once a counterexample has added a state, the tree is restructured by distinguishing sequences
// that the hypothesis has now: for the states below a node after the experiment above, which goes
// on; or for these states alone, instead of the experiments there, if the resets that this spares
// outweigh asking all transitions to them again. The system is asked what it answers from each
// state; where the hypothesis is wrong, that is a counterexample which needs no equivalence query,
// and states that answer alike stay told apart by the old experiments.
//
// Invariant: between two equivalence queries each transition was asked all experiments above the
// leaf it is at. So a counterexample adds a state; restructuring comes later, for it could move the
// transition that the counterexample shows, and nothing would be left to split. For n states and k
// inputs at most n equivalence queries, and some k n^2 output queries, as with other discrimination
// trees: restructuring adds some and spares others.
#pragma once

#include <vector>

#include "maide/learn/observing_oracle.hpp"
#include "maide/learn/tree_learner.hpp"

namespace maide {

// A base, so that it is there before the learner that asks it.
struct AdtKnowledge {
  explicit AdtKnowledge(OutputOracle& oracle) : known_(oracle) {}
  ObservingOracle known_;
};

class Adt : private AdtKnowledge, public TreeLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit Adt(OutputOracle& oracle) : AdtKnowledge(oracle), TreeLearner(known_) {}

  std::uint64_t output_queries() const override { return known_.output_queries(); }

 private:
  using Node = DiscriminationTree::Node;
  using Answers = TreeHypothesis::Answers;

  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
  void complete(const RunControl& control) override;
  void restructure(const RunControl& control) override;

  bool split_by_known_word(StateId state, TreeHypothesis::Transition from, const Word& before);
  void place_waiting(const RunControl& control);
  bool lengthen_over(Node node, const RunControl& control);
  bool replace_below(Node node, const RunControl& control);
  bool is_worth_replacing(Node node) const;
  Answers ask_states(const std::vector<StateId>& states, const Word& before, const Word& label,
                     const DecisionTree& sequence, const RunControl& control);

  Node waiting_ = DiscriminationTree::none;  // a new node whose experiment may still go away
  std::vector<std::size_t> tried_;           // by node: states below when it was restructured
  std::vector<Word> contradictions_;         // words that the hypothesis may be wrong about
};

}  // namespace maide
