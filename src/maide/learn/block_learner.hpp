// What learners share that keep nothing of a counterexample: one shows that the states of a leaf
// are different ones, and they become a block (discrimination_tree.hpp). A block is *finalised*
// where an input a leads its states apart: by outputs, then its suffix is a; or to subtrees that a
// final node with suffix x tells apart, then it is a x. What each state answers to that is known
// already: it costs no query. So final suffixes are closed under suffixes, as access words are
// under prefixes (Isberner, Howar & Steffen, "The TTT Algorithm", RV 2014).
#pragma once

#include <optional>
#include <vector>

#include "maide/learn/tree_learner.hpp"

namespace maide {

class BlockLearner : public TreeLearner {
 protected:
  using Node = DiscriminationTree::Node;
  using TreeLearner::TreeLearner;

  // The block that the state which was added last is in is to be finalised.
  void add_block_of_newest_state();

  // Finalises the first block that an input leads apart, if there is one: then settle() again.
  bool finalise_some_block();

  std::vector<Node> blocks_;  // their roots; empty: all nodes are final

 private:
  std::optional<DiscriminationTree::Inner> find_splitter(Node block) const;
};

}  // namespace maide
