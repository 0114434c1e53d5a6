// Identifiers: a few words for each state of a machine, which come at the end of a conformance test
// and show that the state reached is the one expected.
//
// A family is harmonised if, for every two states that differ, some word that tells them apart is a
// prefix of a word of both (Petrenko, Yevtushenko, Lebedev & Das, "Nondeterministic state machines
// in protocol conformance testing", IWPTS 1993). Tests that end in each state's own words are then
// as complete as those of the W-method, which ends all of them in the same set.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"

namespace maide {

class StateIdentifiers {
 public:
  // The words of each state.
  explicit StateIdentifiers(std::vector<std::vector<Word>> words);
  // The same words for all states.
  explicit StateIdentifiers(std::vector<Word> words);
  // The words of each state, which are some of those for all states, for Wp.
  StateIdentifiers(std::vector<std::vector<Word>> words, const std::vector<Word>& for_all);

  // Not empty: the empty word stands for nothing to tell apart. O(1).
  std::span<const Word> of(StateId state) const { return own_[own_.size() == 1 ? 0 : state]; }
  // Those for all states that are not the state's own: its own identify it only to whom all words
  // have shown that every state is there. O(1).
  std::span<const Word> rest_of(StateId state) const {
    return has_rest() ? std::span<const Word>(rest_[state]) : std::span<const Word>();
  }
  bool has_rest() const { return !rest_.empty(); }

 private:
  std::vector<std::vector<Word>> own_;   // of each state, or of all
  std::vector<std::vector<Word>> rest_;  // of each state; empty if none has any
};

// `machine` must be complete. `random` decides between what serves equally well; not all look at
// it.

// None: the empty word for all states.
StateIdentifiers compute_no_words(const Mealy& machine, Random random);

// W: one characterising set for all states (separating_words.hpp).
StateIdentifiers compute_characterising_words(const Mealy& machine, Random random);

// Wp (Fujiwara, von Bochmann, Khendek, Amalou & Ghedamsi, "Test selection based on finite state
// models", IEEE TSE 1991): of a characterising set for each state few words that tell it from all
// others. Not harmonised: hence the rest. O(|W| n l) and, for what is left after a state's first
// word, O(|W|) each.
StateIdentifiers compute_partial_words(const Mealy& machine, Random random);

// HSI: all states take a shortest word that tells two of them apart; those that answer alike take
// another, among themselves. Harmonised. O(n log n) words in most cases.
StateIdentifiers compute_harmonised_words(const Mealy& machine, Random random);

// Hybrid ADS (Smeenk, Moerman, Vaandrager & Jansen, "Applying automata learning to embedded control
// software", ICFEM 2015; Moerman, "Nominal techniques and black box testing for automata learning",
// PhD thesis, Nijmegen 2019, ch. 2). All states follow one adaptive word through a splitting tree;
// those that merge before they are told apart start again with another, among themselves: nearly
// every state has a word or two. Harmonised: two states have the same words up to the answer that
// differs. The authors complete the first word by a word for each pair; further adaptive words are
// fewer.
StateIdentifiers compute_adaptive_words(const Mealy& machine, Random random);

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
