// ADT (Frohme, "Active Automata Learning with Adaptive Distinguishing Sequences", FMICS 2019, arXiv
// 1902.01139): a discrimination tree whose nodes hold adaptive experiments. Many states are told
// apart without a reset in between. Answers are kept in an observation tree. So nothing is asked
// twice, and the tree shows what tells states apart.
//
// A counterexample is decomposed by binary search (Rivest & Schapire) and splits a leaf. The two
// states are told apart by the first of these that there is:
//
//   a word that is known to do so after the experiment above; it goes on with that experiment
//   a distinguishing sequence that the hypothesis has for them after that experiment; meanwhile
//     the transitions to the leaf wait, for they would be asked twice
//   the shortest word that is known to do so: a new experiment, after a reset
//
// Once a counterexample has added a state, the tree is restructured by distinguishing sequences of
// the new hypothesis. A sequence goes on after the experiment above a node, for the states below
// that node. Or it replaces the experiments there, if the resets that this spares outweigh asking
// all transitions to these states again. The system is asked what it answers from each state. If
// the hypothesis is wrong there, that is a counterexample that needs no equivalence query. States
// that answer alike stay told apart by the old experiments.
//
// Invariant: between two equivalence queries each transition was asked all experiments above its
// leaf. So a counterexample adds a state. Restructuring comes after that. Before, it could move the
// transition that the counterexample shows, and nothing would be left to split. Cost for n states
// and k inputs: at most n equivalence queries, and some k n^2 output queries, as with other
// discrimination trees. Restructuring adds some and spares others.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/tree/tree_learners.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// An adaptive distinguishing sequence of some states of a machine is a decision tree that each of
// them answers in its own way (Lee & Yannakakis, "Testing finite-state machines: state
// identification and verification", IEEE ToC 1994). Few sets of states have one: no two of them may
// become one state before they have answered differently.
//
// The search takes a shortest word that parts the states. Of several it takes the one whose largest
// part is smallest. It goes on with each part. If a part cannot be parted, it takes the next word.
// This is exponential, so the search ends after some effort. A sequence that it does not find may
// still exist.

// For at least two states, none twice, of a complete machine. `effort`: sets of states to look at,
// O(inputs states) each.
std::optional<DecisionTree> find_distinguishing_sequence(const Mealy& machine,
                                                         const std::vector<StateId>& states,
                                                         std::size_t effort);

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
