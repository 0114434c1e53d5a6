// TTT-lambda (Howar & Steffen, "Active Automata Learning as Black-Box Search and Lazy Partition
// Refinement", in A Journey from Process Algebra via Timed Automata to Model Learning, 2022). A
// counterexample only says which word becomes another access word, never by which suffix: binary
// search finds a transition whose word behaves otherwise than the state it leads to. That word and
// the access words of the state share a leaf from then on, a block without a suffix, and have
// transitions each. Only where the counterexample ends with one input after them, no shorter suffix
// can come: it splits the leaf.
//
// Where an input leads them apart the block is finalised (block_learner.hpp). Until then the
// hypothesis is wrong about the rest of the counterexample after one of them: that shorter word is
// the next one, which needs no equivalence query. It is asked only if it is needed: most blocks
// part as soon as the new transitions are sifted.
//
// Invariant: access words are of different states of the system; between two equivalence queries
// all nodes are final, each leaf has one access word. For n states, k inputs and counterexamples of
// length m: at most k n^2 + k n + (n - 1) (3 + (n - 1) ceil(log2 m)) output queries, at most n - 1
// counterexamples.
#pragma once

#include <optional>
#include <vector>

#include "maide/learn/block_learner.hpp"

namespace maide {

class TttLambda : public BlockLearner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit TttLambda(OutputOracle& oracle) : BlockLearner(oracle) {}

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
