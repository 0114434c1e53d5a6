// The discrimination tree (Kearns & Vazirani, "An Introduction to Computational Learning Theory",
// 1994): inner nodes hold a suffix, their branches the output words that it gets, leaves one state
// each. A word is *sifted*: it is asked with the suffix of a node, and the answer says where it
// goes on. What takes a branch that is not there has found a new state.
//
// The transitions of all states are sifted together, a level of the tree in one batch, so that many
// systems can answer at once. A leaf keeps the transitions that lead to it: when it is split, only
// these are sifted again, from there.
//
// Invariant: access(q) takes the path to the leaf of q. For n states, k inputs: at most n k (depth
// of the tree) output queries, and what a split needs.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/output_oracle.hpp"

namespace maide {

class DiscriminationTree {
 public:
  using Node = std::uint32_t;
  // The transition of a state by an input: state x inputs + input.
  using Transition = std::uint32_t;
  static constexpr Node root = 0;
  static constexpr Node none = ~Node{0};

  // One leaf: the initial state. Keeps a reference to `oracle`. Throws UsageError if it has no
  // inputs.
  explicit DiscriminationTree(OutputOracle& oracle);

  std::size_t size() const { return access_.size(); }  // states
  const Word& access(StateId state) const { return access_[state]; }
  // The state that a transition leads to, and its output; settled transitions only.
  StateId target(Transition transition) const { return state_[place_[transition]]; }
  Symbol output(Transition transition) const { return output_[transition]; }

  // Sifts all transitions that are not settled; finds new states on the way. May be called again
  // after an exception.
  void settle(const RunControl& control);

  // Splits the leaf of `state`: `access` is the access word of a new state, the last step of which
  // is the transition `from`, and `suffix` gets other outputs from there. Returns false, and does
  // nothing, if it gets the same. Two output queries. Afterwards settle().
  bool split(StateId state, Transition from, const Word& suffix, const RunControl& control);

  std::uint64_t output_queries() const { return output_queries_; }

 private:
  struct Inner {
    Node parent = none;
    Word suffix;                     // empty: a leaf
    std::map<Word, Node> branches;   // by output word
    std::vector<Transition> coming;  // of a leaf: transitions that lead to it, and some that did
  };

  Node add_leaf(Node parent, StateId state);
  StateId add_state(Word access, Transition from);
  Word word_to(Transition transition) const;
  void follow(Transition transition, const Word& outputs, std::size_t prefix);

  OutputOracle& oracle_;
  std::vector<Inner> nodes_;
  std::vector<StateId> state_;        // by node: of a leaf
  std::vector<Node> leaf_;            // by state
  std::vector<Word> access_;          // by state
  std::vector<Transition> spanning_;  // by state: the transition that it was found by
  std::vector<Node> place_;           // by transition: the node it has come to
  std::vector<Symbol> output_;        // by transition
  std::vector<Transition> unsettled_;
  std::uint64_t output_queries_ = 0;
};

}  // namespace maide
