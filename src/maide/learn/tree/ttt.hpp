// TTT and TTT-lambda, learners with a discrimination tree that keep nothing of a counterexample,
// however long it is. They share `FinalizingLearner`.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "maide/learn/tree/tree_learners.hpp"

namespace maide {

// What both share (Isberner, Howar & Steffen, "The TTT Algorithm", RV 2014). A counterexample shows
// that the states of a leaf are different ones, and they become a block (discrimination_tree.hpp).
// A block is *finalised* once an input a leads its states apart. If it does so by outputs, the
// suffix of the block is a. If it leads to subtrees that a final node with suffix x tells apart,
// the suffix is a x. What each state answers to that is known already, so it costs no query. So
// final suffixes are closed under suffixes, as access words are under prefixes.
class FinalizingLearner : public TreeLearner {
 public:
  void check_invariants() const override;

 protected:
  using Node = DiscriminationTree::Node;
  using TreeLearner::TreeLearner;

  // Marks the block that holds the newest state as one to be finalised.
  void add_block_of_newest_state();

  // Finalises the first block that an input leads apart, if there is one: then settle() again.
  bool finalise_some_block();

  std::vector<Node> blocks_;  // their roots; empty: all nodes are final

 private:
  std::optional<DiscriminationTree::Inner> find_splitter(Node block) const;
};

// TTT (Isberner, Howar & Steffen, "The TTT Algorithm: A Redundancy-Free Approach to Active Automata
// Learning", RV 2014): a spanning tree, a discrimination tree and a set of suffixes that is closed
// under suffixes.
//
// A counterexample splits a leaf as in the observation pack (Rivest & Schapire), but only for a
// time: the new nodes are a block that is to be finalised. The hypothesis contradicts what is known
// if no input leads the states of a block apart, or if a final node says otherwise than the
// hypothesis predicts. That is a counterexample that needs no equivalence query.
//
// Invariant: between two equivalence queries all nodes are final, and the hypothesis agrees with
// all of them. For n states, k inputs and counterexamples of length m: at most k n^2 + k n + (n -
// 1) (3 + ceil(log2 m)) output queries, at most n - 1 counterexamples.
class Ttt : public FinalizingLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit Ttt(OutputOracle& oracle) : FinalizingLearner(oracle) {}

 private:
  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
  void complete(const RunControl& control) override;

  // Splits a leaf by a suffix of `word`, temporarily. See split_by_suffix().
  bool split_for_a_time(std::span<const StateId> states, const Word& word, Symbol last_output,
                        const RunControl& control);
  void split_block(Node block, const RunControl& control);
  bool split_where_a_claim_fails(const RunControl& control);

  // A state and a final node above its leaf.
  struct Claim {
    StateId state;
    Node node;
  };
  bool is_certain(const Claim& claim) const;

  std::vector<Claim> claims_;  // that may contradict the hypothesis
  StateId examined_ = 0;       // states from here on have no claims yet
};

// TTT-lambda (Howar & Steffen, "Active Automata Learning as Black-Box Search and Lazy Partition
// Refinement", in A Journey from Process Algebra via Timed Automata to Model Learning, 2022). A
// counterexample only names another access word. It never adds a suffix. Binary search finds a
// transition whose word behaves otherwise than the state that it leads to. That word then shares a
// leaf with the access words of the state: a block without a suffix. Each of its words has
// transitions. If the counterexample has one input behind them, no shorter suffix can come, so that
// input splits the leaf.
//
// Otherwise the block is finalised as soon as an input leads its states apart. Until then the
// hypothesis is wrong about the rest of the counterexample after one of them. That shorter word is
// the next counterexample. It needs no equivalence query, and is asked only if it is needed: most
// blocks part as soon as the new transitions are sifted.
//
// Invariant: access words are of different states of the system. Between two equivalence queries
// all nodes are final, and each leaf has one access word. For n states, k inputs and
// counterexamples of length m: at most k n^2 + k n + (n - 1) (3 + (n - 1) ceil(log2 m)) output
// queries, at most n - 1 counterexamples.
class TttLambda : public FinalizingLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit TttLambda(OutputOracle& oracle) : FinalizingLearner(oracle) {}

 private:
  bool split(const Word& counterexample, std::span<const Symbol> outputs,
             const RunControl& control) override;
  void complete(const RunControl& control) override;

  // After the access word of `state`, the hypothesis is wrong about the last output of `word`, and
  // about no other; the system says `last_output`.
  struct Mistake {
    StateId state;
    Word word;
    Symbol last_output;
  };
  std::optional<Mistake> find_mistake_after(StateId state, const Word& word,
                                            const RunControl& control);
  std::optional<Mistake> find_mistake(StateId state, const Word& word, const RunControl& control);
  bool promote_along(Mistake mistake, const RunControl& control);
  void follow_witness(const RunControl& control);

  // After the access word of `state` the system answers `suffix` otherwise than after those that
  // were in its leaf before.
  struct Witness {
    StateId state;
    Word suffix;
    Symbol last_output;  // the system's, after the state and the suffix
  };
  std::vector<Witness> witnesses_;  // the newest last; of states that are in blocks, and others
};

}  // namespace maide
