// The discrimination tree (Kearns & Vazirani, "An Introduction to Computational Learning Theory",
// 1994). Inner nodes hold a suffix, their children hang from the outputs to it, and leaves hold one
// state each. A word goes down by the answers to itself and the suffix of each node. Here is the
// tree alone; TreeHypothesis asks.
//
// Example: the suffix `a` at the root parts words behind which `a` is answered 0 from those behind
// which it is answered 1. Two words of one leaf count as one state, until a counterexample splits
// it.
//
// A node may be *temporary* (TTT: Isberner, Howar & Steffen, RV 2014). Its suffix came out of a
// counterexample and will be replaced by a shorter one. Or it has no suffix yet, and one is still
// to be found for its states (TTT-lambda: Howar & Steffen 2022). A maximal subtree of temporary
// nodes is a *block*. All other nodes stay what they are.
//
// A node may hold an adaptive *experiment* instead of a suffix: a decision tree that ends with each
// output that it has no branch for (ADT: Frohme, FMICS 2019). The outputs to it, of different
// lengths, are the labels. The system is reset from one experiment to the next. Better experiments
// replace it.
//
// Invariant: every state has a leaf, and answers the suffix of each node above it as the labels
// say.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

class DiscriminationTree {
 public:
  using Node = std::uint32_t;
  static constexpr Node root = 0;
  static constexpr Node none = ~Node{0};

  // One leaf, of state 0.
  DiscriminationTree();

  bool is_leaf(Node node) const { return nodes_[node].state != Mealy::no_state; }
  bool is_temporary(Node node) const { return nodes_[node].temporary; }
  Node leaf(StateId state) const { return leaf_[state]; }
  StateId state(Node leaf) const { return nodes_[leaf].state; }
  Node parent(Node node) const { return nodes_[node].parent; }
  // Of an inner node; empty for leaves, and where none is known yet.
  const Word& suffix(Node node) const { return nodes_[node].suffix; }
  // Of an inner node that asks no suffix; without nodes for the others.
  const DecisionTree& experiment(Node node) const { return nodes_[node].experiment; }
  // There is something to ask.
  bool has_question(Node node) const {
    return !nodes_[node].suffix.empty() || !nodes_[node].experiment.nodes.empty();
  }
  // The node whose suffix is that of this node without its first input, where it was given.
  Node rest(Node node) const { return nodes_[node].rest; }
  // The answer to the parent's suffix from which the node hangs.
  const Word& label(Node node) const { return nodes_[node].label; }
  // The inputs that the label answers. O(their number).
  Word inputs_to(Node node) const;
  std::span<const Node> children(Node node) const { return nodes_[node].children; }
  // The state that stands for those below a node: that of its first leaf. O(depth).
  StateId representative(Node node) const;

  // The states below a node, in the order of the tree. O(nodes below).
  std::vector<StateId> states_below(Node node) const;

  // The child that hangs from this answer, or none. O(log children) comparisons.
  Node child(Node node, std::span<const Symbol> answer) const;
  // The lowest node that has both below it (or is one of them). O(depth).
  Node common_ancestor(Node left, Node right) const;
  // The child of `ancestor` that has `below` in its subtree, or none. O(depth).
  Node child_towards(Node ancestor, Node below) const;
  // The uppermost temporary node above `node` or itself; `node` where there is none. O(depth).
  Node block_of(Node node) const;
  // Leaves below a node, in the order of the tree.
  void for_each_leaf(Node node, const std::function<void(Node)>& visit) const;

  // Adds a leaf for the next state.
  Node add_leaf(Node parent, Word label);

  // What becomes of a node.
  struct Inner {
    Word suffix;
    Node rest = none;  // see rest()
    bool temporary = false;
    DecisionTree experiment = {};  // if there is no suffix
  };
  // Makes a leaf an inner node that has one child, a new leaf of the leaf's state.
  void split(Node leaf, Inner inner, Word label);

  // Gives the block with this root a suffix for good; `answer` says what each of its states
  // answers. Below it, states that answer alike stay told apart by what did so before.
  void finalise(Node block, Inner inner, const std::function<Word(StateId)>& answer);

  // Replaces the experiment above an inner node by one that goes on where the node hung. The states
  // below the node then hang from their answers to it. States that answer alike stay told apart as
  // they were before.
  void lengthen(Node node, DecisionTree experiment, const std::function<Word(StateId)>& answer);

  // Throws std::logic_error unless every state has its leaf, and every inner node a question and
  // children in the order of different answers to it. O(nodes x length).
  void check_invariants() const;

 private:
  struct Record {
    Node parent = none;
    StateId state = Mealy::no_state;  // of a leaf
    Node rest = none;
    bool temporary = false;
    Word suffix;
    DecisionTree experiment;
    Word label;
    std::vector<Node> children;  // ascending by label, by age where labels are the same
  };

  Node add_node(Record record);
  void hang(Node parent, Node child, Word label);
  Node extract(Node source, const std::vector<bool>& chosen);
  std::vector<std::pair<Node, Word>> regroup(Node node, const std::function<Word(StateId)>& answer);
  void release(Node node);
  void check_inner(Node node) const;

  std::vector<Record> nodes_;
  std::vector<Node> leaf_;  // by state
  std::vector<Node> free_;  // nodes that are not in the tree any more
};

}  // namespace maide
