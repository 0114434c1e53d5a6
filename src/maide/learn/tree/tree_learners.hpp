// Learners with a discrimination tree: what they all share (`TreeLearner`), Kearns & Vazirani's,
// and the observation pack. TTT and ADT have files of their own. They differ in how a
// counterexample splits the tree.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/tree/discrimination_tree.hpp"

namespace maide {

// The hypothesis of learners with a discrimination tree: a spanning tree of access words, and for
// every transition a place in the discrimination tree, to which it was *sifted*. To sift a word is
// to ask it with the suffix of a node. The answer says to which child it goes on. A word whose
// answer has no child yet has found a new state.
//
// Transitions are sifted together, level by level, in batches, so that many systems can answer at
// once. A node keeps the transitions that came to it. When a leaf is split, only these go on from
// there. Transitions stop at leaves and at the roots of blocks (discrimination_tree.hpp).
//
// Invariant: access words are prefix-closed, and access(q) takes the path to the leaf of q. A state
// keeps its number, so that from one hypothesis to the next only what was learned changes. Cost for
// n states and k inputs: at most n k (depth of the tree) output queries, and those of splits.
class TreeHypothesis {
 public:
  using Node = DiscriminationTree::Node;
  // The transition of a state by an input: state x inputs + input.
  using Transition = std::uint32_t;
  static constexpr Transition no_transition = ~Transition{0};

  // One state. Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit TreeHypothesis(OutputOracle& oracle);

  // The machine as of the last update(); without states before the first.
  const Mealy& machine() const { return machine_; }
  const DiscriminationTree& tree() const { return tree_; }
  std::size_t size() const { return access_.size(); }  // states found
  const Word& access(StateId state) const { return access_[state]; }
  std::span<const Word> access() const { return access_; }
  Transition transition(StateId state, Symbol input) const {
    return static_cast<Transition>(state * oracle_.inputs().size() + input);
  }
  Word word_to(Transition transition) const;
  // The outputs along access(state). O(length).
  Word access_outputs(StateId state) const;

  // The word to it is the access word of a state.
  bool is_spanning(Transition transition) const {
    const Node node = place_[transition];
    return tree_.is_leaf(node) && spanning_[tree_.state(node)] == transition;
  }

  // Transitions that have come to this node.
  std::size_t coming_count(Node node) const {
    return node < coming_.size() ? coming_[node].size() : 0;
  }
  // Where a settled transition has come to, and its output.
  Node place(Transition transition) const { return place_[transition]; }
  Symbol output(Transition transition) const { return output_[transition]; }

  // Sifts all transitions that are not settled; finds new states on the way. After an
  // exception the machine of the last update() can still be read, no more.
  void settle(const RunControl& control);

  // Makes the machine anew out of what was settled since. Transitions are at leaves, or in blocks:
  // then they lead to the state that stands for the others. O(changes).
  void update();

  // Splits the leaf of `state`: word_to(from), which is in it, becomes the access word of a new
  // state, for `suffix` gets other outputs from there. Returns false, and does nothing, if it gets
  // the same. Two output queries. Afterwards settle(): unless the suffix is temporary, the
  // transitions to the leaf go on.
  bool split(StateId state, Transition from, DiscriminationTree::Inner inner,
             const RunControl& control);

  // The same where it is known what the state and word_to(from) answer. No output queries.
  void split(StateId state, Transition from, DiscriminationTree::Inner inner, Word old_label,
             Word new_label);

  // Splits the leaf of `state`, which answers `label`, without another state: if one of the
  // transitions that go on from there answers otherwise, settle() finds it.
  void split(StateId state, DiscriminationTree::Inner inner, Word label);

  // Makes word_to(from) the access word of a new state. The word is at a leaf or in a block, and
  // nothing there tells it from the other words yet. The leaf becomes a block. No output queries.
  // The caller knows that the state is another one, so that finalise() will part them. Call
  // settle() afterwards.
  void promote(Transition from);

  // The uppermost node on the way to the state's leaf whose suffix is answered differently after
  // `word` and from the state. None if the word is sifted to that leaf. At most depth output
  // queries.
  std::optional<Node> find_disagreement(const Word& word, StateId state, const RunControl& control);

  // What a state answers to `input` and the suffix of `node`, which the transition has passed (or
  // to the input alone, for no node): known without asking.
  Word known_answer(StateId state, Symbol input, Node node) const;

  // Sifts a transition that is in a block down to a leaf of it, now. At most depth output queries.
  StateId target_in_block(Transition transition, const RunControl& control);

  // See DiscriminationTree::finalise; what a state answers is the known answer to the first input
  // of the suffix and its rest. The transitions to the block go on. Afterwards settle().
  void finalise(Node block, DiscriminationTree::Inner inner);

  // What each of some states answers.
  using Answers = std::map<StateId, Word>;
  // The same with answers that were asked for, for any inner node.
  void replace(Node node, DiscriminationTree::Inner inner, const Answers& answers);
  // See DiscriminationTree::lengthen. The transitions to these states go on. Afterwards settle().
  void lengthen(Node node, DecisionTree experiment, const Answers& answers);

  std::uint64_t output_queries() const { return output_queries_; }

  // Throws std::logic_error unless access words are prefix-closed and lead to the leaves of their
  // states, each transition is in one place, and the machine is up to date if it should be.
  // O(transitions).
  void check_invariants() const;

 private:
  // Asks `suffix` after `prefix`: one output query.
  Word ask_after(Word prefix, const Word& suffix, const RunControl& control);
  Query question(Transition transition) const;
  std::vector<Transition> take_coming_below(Node node);
  void send_back(const std::vector<Transition>& transitions, const Answers& states, Node node);
  void add_transitions();
  StateId add_state(Node parent, Word label, Transition from);
  void follow(Transition transition, const Word& outputs);
  void put(Transition transition, Node node);
  std::vector<Transition> take_coming(Node node);
  // Moves the transitions that came to the leaf of `state`, which has become an inner node. The
  // spanning transitions of `state` and of `added` (unless there is none) go to their leaves. The
  // others go on, or stay.
  void go_on(Node inner, StateId state, StateId added, bool stay);

  OutputOracle& oracle_;
  DiscriminationTree tree_;
  Mealy machine_;
  std::vector<Word> access_;          // by state
  std::vector<Transition> spanning_;  // by state: the transition that it was found by
  std::vector<Node> place_;           // by transition: the node it has come to
  std::vector<Symbol> output_;        // by transition
  std::vector<Transition> unsettled_;
  std::vector<Transition> changed_;              // since the machine was made
  std::vector<std::vector<Transition>> coming_;  // by node: transitions that stopped there
  std::uint64_t output_queries_ = 0;
};

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
