// The observation tree of L# (Vaandrager, Garhewal, Rot & Wissmann, "A New Approach for Active
// Automata Learning Based on Apartness", TACAS 2022): every word that was asked, as a partial Mealy
// machine in the form of a tree. Two nodes are *apart* if some word that is known from both gets
// different outputs. No later answer can take that back.
//
// Example: a node from which `a` got 0 is apart from one from which `a` got 1. From one from which
// only `b` was asked it is not apart, though it may be another state.
//
// Invariant: adding words only makes more nodes apart. An edge takes 16 bytes; nodes that many
// words leave have a table of children, the others a list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

class ObservationTree {
 public:
  using Node = std::uint32_t;
  static constexpr Node root = 0;
  static constexpr Node none = ~Node{0};

  // For words over this many inputs.
  explicit ObservationTree(std::size_t inputs) : inputs_(inputs), nodes_(1) {}

  std::size_t input_count() const { return inputs_; }
  std::size_t size() const { return nodes_.size(); }

  // The child of `node` by `input`, or none. O(1) for nodes with a table, else O(children).
  Node child(Node node, Symbol input) const {
    const Record& record = nodes_[node];
    if (record.has_table) return tables_[record.child + input];
    Node next = record.child;
    while (next != none && nodes_[next].input != input) next = nodes_[next].sibling;
    return next;
  }
  // The node that `word` leads to from `node`, or none. O(length).
  Node find(Node node, std::span<const Symbol> word) const;

  // Of the edge that leads to `node`, which is not the root.
  Symbol input(Node node) const { return nodes_[node].input; }
  Symbol output(Node node) const { return nodes_[node].output; }

  // Calls `visit(child)` for the children of `node`, in an order that depends on nothing but the
  // words inserted. O(children), or O(inputs) for nodes with a table.
  template <typename Visit>
  void for_each_child(Node node, Visit&& visit) const {
    const Record record = nodes_[node];
    if (record.has_table) {
      for (std::size_t i = 0; i < inputs_; ++i) {
        if (tables_[record.child + i] != none) visit(tables_[record.child + i]);
      }
      return;
    }
    for (Node next = record.child; next != none; next = nodes_[next].sibling) visit(next);
  }

  // Adds a word with its outputs. Returns how many of its first edges were there before. If an
  // output contradicts the tree, nothing is added and `conflict` (below) tells so.
  struct Inserted {
    std::size_t known = 0;
    bool conflict = false;  // at edge `known`
  };
  Inserted insert(std::span<const Symbol> inputs, std::span<const Symbol> outputs);

  // Gives the node a table of children: for nodes from which every input will be asked.
  void make_table(Node node);

  // Whether some word known from both nodes gets different outputs. O(the smaller subtree).
  bool are_apart(Node left, Node right) const;
  // A shortest such word; empty if there is none. O(what the two subtrees share).
  Word find_witness(Node left, Node right) const;

 private:
  struct Record {
    Node child = none;    // the first child, or where the table begins
    Node sibling = none;  // the next child of the same parent
    std::uint32_t has_table : 1 = 0;
    std::uint32_t input : 31 = 0;
    Symbol output = 0;
  };
  static_assert(sizeof(Record) == 16);

  Node add_child(Node node, Symbol input, Symbol output);

  std::size_t inputs_;
  std::vector<Record> nodes_;
  std::vector<Node> tables_;
};

}  // namespace maide
