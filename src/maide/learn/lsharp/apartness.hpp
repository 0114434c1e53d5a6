// Basis and frontier of L#'s observation tree. The *basis* holds the access words of the states
// found so far: prefix-closed, pairwise apart, numbered in the order in which they were found. The
// *frontier* are the nodes one input away from it. The *candidates* of a frontier node are the
// basis states that it is not apart from. A node without candidates is a new state; a node with one
// is identified.
//
// Candidates are kept up to date and not computed anew. A new word passes some basis states and
// then one frontier node, and only pairs with one of these can have become apart, by that very
// word. Candidates are kept by what is known of a frontier node, not by node
// (frontier_classes.hpp).
//
// A basis state from which not all inputs were asked is hardly known, so it would be a candidate
// almost everywhere. It becomes a candidate once they were asked. Until then a node that is apart
// from all candidates, but not from such a state, waits for it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/lsharp/frontier_classes.hpp"
#include "maide/learn/lsharp/observation_tree.hpp"

namespace maide {

class Apartness {
 public:
  using Node = ObservationTree::Node;
  // The transition of a basis state by an input: state x inputs + input.
  using Transition = std::uint32_t;

  // The basis is the root.
  explicit Apartness(std::size_t inputs);

  const ObservationTree& tree() const { return tree_; }
  std::size_t input_count() const { return tree_.input_count(); }
  std::size_t size() const { return basis_.size(); }  // of the basis
  std::size_t transition_count() const { return basis_target_.size(); }
  Node node(StateId state) const { return basis_[state]; }
  const Word& access(StateId state) const { return access_[state]; }
  Word word_to(Transition transition) const;
  // The transition that a state, not the initial one, was found by.
  Transition entry(StateId state) const { return entry_[state]; }
  StateId source(Transition transition) const {
    return static_cast<StateId>(transition / input_count());
  }
  Symbol input(Transition transition) const {
    return static_cast<Symbol>(transition % input_count());
  }

  // The node that a transition leads to; none if that input was not asked there yet.
  Node target_node(Transition transition) const {
    return tree_.child(basis_[source(transition)], input(transition));
  }
  // The basis state that a transition leads to if its node is in the basis, else no_state.
  StateId basis_target(Transition transition) const { return basis_target_[transition]; }
  // Basis states, from which all inputs were asked, that the transition's node, which is in the
  // frontier, is not apart from; ascending.
  const std::vector<StateId>& candidates(Transition transition) const {
    static const std::vector<StateId> nothing;
    const FrontierClasses::Class at = classes_.class_of(transition);
    return at == FrontierClasses::none ? nothing : classes_.candidates(at);
  }
  // The state that a transition leads to as far as it is known, else no_state.
  StateId target(Transition transition) const {
    if (basis_target_[transition] != Mealy::no_state) return basis_target_[transition];
    const std::vector<StateId>& possible = candidates(transition);
    return possible.size() == 1 ? possible.front() : Mealy::no_state;
  }
  // The frontier by what is known of its nodes. Members are transitions.
  FrontierClasses& classes() { return classes_; }
  const FrontierClasses& classes() const { return classes_; }

  // Adds a word. See ObservationTree::insert.
  ObservationTree::Inserted insert(const Word& inputs, const Word& outputs);

  // Some frontier node is apart from all of the basis.
  bool has_isolated();
  // Makes all of these that are apart from each other, too, states of the basis.
  void promote_isolated();

  // Throws std::logic_error unless the basis is prefix-closed and pairwise apart, and the
  // candidates of each frontier node are those that the tree says. O(transitions x states x what is
  // known).
  void check_invariants() const;

 private:
  void add_state(Node node, Word access, Transition entry);
  void find_class(Transition transition);
  void look_at_waiting(StateId state);
  bool must_wait(Transition transition);
  void check_transition(Transition transition) const;
  bool is_new(Transition transition) const {
    return basis_target_[transition] == Mealy::no_state && candidates(transition).empty();
  }

  ObservationTree tree_;
  std::vector<Node> basis_;
  std::vector<Word> access_;
  std::vector<Transition> entry_;
  std::vector<StateId> basis_target_;  // by transition
  FrontierClasses classes_;
  std::vector<std::size_t> unasked_;  // by state: inputs
  std::vector<StateId> incomplete_;   // states that lack inputs, ascending
  // By state: frontier nodes that are apart from all candidates, but not from this incomplete
  // state; and some that are no more.
  std::vector<std::vector<Transition>> waiting_;
  std::vector<Transition> isolated_;  // and some that are not
};

}  // namespace maide
