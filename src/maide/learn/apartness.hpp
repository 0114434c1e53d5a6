// Basis and frontier of L#'s observation tree. The *basis* holds the access words of the states
// found so far: prefix-closed, pairwise apart, numbered in the order in which they were found. The
// *frontier* are the nodes one input away from it. A frontier node's *candidates* are the basis
// states that it is not apart from: with none it is a new state, with one it is identified.
//
// Candidates are kept up to date instead of computed: a new word passes some basis states and then
// one frontier node, and only pairs with one of these can have become apart, by that very word. So
// each pair walks a suffix of the word, and no subtrees are compared. O(length x pairs concerned).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/observation_tree.hpp"

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
  // Basis states that the transition's node, which is in the frontier, is not apart from;
  // ascending.
  const std::vector<StateId>& candidates(Transition transition) const {
    return candidates_[transition];
  }
  // The state that a transition leads to as far as it is known, else no_state.
  StateId target(Transition transition) const {
    if (basis_target_[transition] != Mealy::no_state) return basis_target_[transition];
    return candidates_[transition].size() == 1 ? candidates_[transition].front() : Mealy::no_state;
  }

  // Adds a word. See ObservationTree::insert.
  ObservationTree::Inserted insert(const Word& inputs, const Word& outputs);

  // Frontier nodes that became apart from all of the basis, the first first.
  const std::vector<Transition>& isolated() const { return isolated_; }
  // Makes all isolated nodes that are apart from each other, too, states of the basis. Returns the
  // first of the new states.
  StateId promote_isolated();

 private:
  void add_state(Node node, Word access);
  void find_candidates(Transition transition);
  bool are_apart_by(Node node, std::span<const Symbol> inputs,
                    std::span<const Symbol> outputs) const;
  void remove_candidate(Transition transition, StateId state);

  ObservationTree tree_;
  std::vector<Node> basis_;
  std::vector<Word> access_;
  std::vector<StateId> basis_target_;              // by transition
  std::vector<std::vector<StateId>> candidates_;   // by transition
  std::vector<std::vector<Transition>> watchers_;  // by state: transitions it is a candidate of,
                                                   // and some that it was
  std::vector<Transition> isolated_;
};

}  // namespace maide
