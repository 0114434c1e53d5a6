// TTT (Isberner, Howar & Steffen, "The TTT Algorithm: A Redundancy-Free Approach to Active Automata
// Learning", RV 2014): a spanning tree, a discrimination tree and a set of suffixes that is closed
// under suffixes, so that however long counterexamples are, nothing of them stays.
//
// A counterexample splits a leaf as in the observation pack (Rivest & Schapire), but only for a
// time, until the block of such nodes is finalised (block_learner.hpp). Where no input leads the
// states of a block apart, or a final node says otherwise than the hypothesis predicts, the
// hypothesis contradicts what is known: that is a counterexample which needs no equivalence query.
//
// Invariant: between two equivalence queries all nodes are final, and the hypothesis agrees with
// all of them. For n states, k inputs and counterexamples of length m: at most k n^2 + k n + (n -
// 1) (3 + ceil(log2 m)) output queries, at most n - 1 counterexamples.
#pragma once

#include <vector>

#include "maide/learn/block_learner.hpp"

namespace maide {

class Ttt : public BlockLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit Ttt(OutputOracle& oracle) : BlockLearner(oracle) {}

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

}  // namespace maide
