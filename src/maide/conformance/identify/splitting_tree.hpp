// Splitting trees for adaptive distinguishing sequences (Lee & Yannakakis, "Testing finite-state
// machines: state identification and verification", IEEE ToC 1994). An inner node is a set of
// states with a word that they do not all answer alike; its children are the parts. A split is
// valid if no two states become one without having answered differently. Below valid splits alone,
// a single adaptive word identifies every state.
//
// Few machines allow that everywhere: whatever ends in an error state merges. As in hybrid ADS
// (Smeenk, Moerman, Vaandrager & Jansen, "Applying automata learning to embedded control software",
// ICFEM 2015) the tree goes on where no valid split is left. It takes the input by which fewest
// pairs are lost, in the largest set that is left. Below it there may be valid splits again.
//
// Invariants: a leaf is a set of states not yet told apart. An input that leads from a leaf into
// one leaf waits there until that one is split, and is not looked at in between. A valid split is
// always made before one that is not. So if the machine has an adaptive distinguishing sequence,
// all splits are valid.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"

namespace maide {

class SplittingTree {
 public:
  using NodeId = std::uint32_t;
  static constexpr NodeId none = ~NodeId{0};

  // Inputs that serve equally well are tried in an order drawn from `random`. `machine` must be
  // complete; it is not kept. Mostly O(n k log n), at worst O(n^2 k).
  SplittingTree(const Mealy& machine, Random random);

  // The leaf of a state; equivalent states have the same one. O(1).
  NodeId leaf_of(StateId state) const { return leaf_[state]; }
  // The lowest node above both. O(depth).
  NodeId common_ancestor(NodeId left, NodeId right) const;

  // The word of an inner node is `input`, then the word of `next` (none: it ends here). The states
  // of the node differ in their answers to its last input, and only there.
  Symbol input(NodeId node) const { return nodes_[node].input; }
  NodeId next(NodeId node) const { return nodes_[node].next; }

  // Classes of states that no word tells apart: the leaves.
  std::size_t class_count() const { return class_count_; }
  // Splits in which states merged unseen.
  std::size_t invalid_count() const { return invalid_count_; }

 private:
  friend class AdaptiveSplitter;
  struct Node {
    NodeId parent = none;
    std::uint32_t depth = 0;
    Symbol input = 0;
    NodeId next = none;
  };
  std::vector<Node> nodes_;
  std::vector<NodeId> leaf_;
  std::size_t class_count_ = 0, invalid_count_ = 0;
};

}  // namespace maide
