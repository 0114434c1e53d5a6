// A model of an earlier version of the system, and what it offers a learner: words that lead to its
// states, words that tell them apart, and a guess which of them a state of the new system is. All
// words are over the inputs that the new system has, too. They are candidates, never facts
// (Ferreira, van Heerdt & Silva, "Tree-based adaptive model learning", A Journey from Process
// Algebra via Timed Automata to Model Learning, 2022).
//
// The old machine is restricted to the common inputs, minimised, and learned by L# itself, which
// costs no query. The observation tree of that run holds the separating words, and an adaptive
// distinguishing sequence for all states is read off it.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/learn/lsharp/apartness.hpp"

namespace maide {

class Apartness;

// The machine over those of its inputs that `inputs` has, in that order. O(n k).
Mealy restrict_inputs(const Mealy& machine, const Alphabet& inputs);

// The old machine over the common inputs, with its words.
class OldModel {
 public:
  // Of a complete machine, for a system with these inputs. Inputs go by name. O(learning it);
  // throws Interrupted if `control` says so.
  OldModel(const Mealy& machine, const Alphabet& inputs, const RunControl& control = {});
  ~OldModel();
  OldModel(OldModel&&) noexcept;
  OldModel& operator=(OldModel&&) noexcept;

  // Of the restricted, minimal machine; its states are all reachable.
  std::size_t size() const { return machine_.size(); }
  StateId initial() const { return machine_.initial(); }
  const Alphabet& outputs() const { return machine_.outputs(); }

  // All words here are over the new system's inputs.
  bool has_input(Symbol input) const { return to_old_[input] != unknown; }
  StateId target(StateId state, Symbol input) const {
    return machine_.target(state, to_old_[input]);
  }
  Symbol output(StateId state, Symbol input) const {  // in outputs()
    return machine_.output(state, to_old_[input]);
  }

  // The way of `state` through the adaptive distinguishing sequence of all states: as many
  // states as it can tell apart answer it in their own way.
  const Word& identifying_word(StateId state) const { return identifying_[state]; }
  // A word that tells two different states apart. O(what is known of both).
  Word separating_word(StateId left, StateId right) const;

  // Each state's access word, followed by words that tell it from all the others: to be tested
  // first, they show whatever states of the old model are still there.
  std::vector<Word> test_words() const;

 private:
  static constexpr Symbol unknown = ~Symbol{0};

  void learn_itself(const RunControl& control);
  void find_identifying_words();
  Word to_new(const Word& word) const;

  Mealy machine_;                         // over the common inputs
  std::vector<Symbol> to_old_, to_new_;   // inputs
  std::vector<Word> identifying_;         // by state
  std::unique_ptr<Apartness> knowledge_;  // of machine_; its basis are all states
  std::vector<StateId> basis_state_;      // of each state of the machine
};

// Matches each state found by L# with the state of an old model that it probably is: the one that
// contradicts what is known of it in the fewest places (approximate state matching: Kruger, Junges
// & Rot, "State Matching and Multiple References in Adaptive Active Automata Learning", FM 2024,
// arXiv 2406.19714). A match is a guess. It chooses what is asked, never what is believed.
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
