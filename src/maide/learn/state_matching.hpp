// Which state of an old model a state found by L# probably is: the one that contradicts what is
// known of it in the fewest places (Kruger, Junges & Rot, "State Matching and Multiple References
// in Adaptive Active Automata Learning", FM 2024, arXiv 2406.19714: approximate state matching).
// A match is a guess; it chooses what is asked, never what is believed.
#pragma once

#include <utility>
#include <vector>

#include "maide/learn/apartness.hpp"
#include "maide/learn/old_model.hpp"

namespace maide {

class StateMatching {
 public:
  explicit StateMatching(OldModel old_model)
      : old_(std::move(old_model)), matched_by_(old_.size(), none) {}

  static constexpr StateId none = Mealy::no_state;
  const OldModel& old_model() const { return old_; }

  // Matches the states of the basis that are new, and again those of which more is known since.
  // `outputs` names the outputs in the tree. O(basis), and O(old states) for each that is matched:
  // a bounded part of what is known below it is looked at, and no state is looked at often.
  void update(const Apartness& apartness, const Alphabet& outputs);

  // The old state that the target of a transition of the basis probably is; none if the input is
  // new.
  StateId expected(const Apartness& apartness, Apartness::Transition transition) const;
  // Whether the old model has this output there.
  bool agrees(const Apartness& apartness, Apartness::Transition transition, Symbol output) const;

  StateId match(StateId state) const { return match_[state]; }  // of a basis state
  // A basis state that was matched with this old one, or none.
  StateId matched_by(StateId old_state) const { return matched_by_[old_state]; }

 private:
  // An edge of the tree below a state; the first of them stands for the state itself.
  struct Seen {
    std::size_t parent = 0;  // place of the edge before it
    Symbol input = 0, output = 0;
  };
  StateId guess(const Apartness& apartness, StateId state) const;
  void look_below(const ObservationTree& tree, ObservationTree::Node node);  // nearest first
  std::size_t count_contradictions(StateId old_state, std::size_t limit);
  StateId find_best(StateId first);

  OldModel old_;
  std::vector<StateId> match_;          // by basis state
  std::vector<std::size_t> next_look_;  // by basis state: the size of the tree when to match again
  std::vector<StateId> matched_by_;     // by old state
  std::vector<Symbol> old_output_;      // by output in the tree
  std::vector<Seen> below_;
  std::vector<StateId> reached_;  // by the old machine along each of below_
};

}  // namespace maide
