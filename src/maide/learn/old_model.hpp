// What a model of an earlier version of the system still offers to a learner: words that lead to
// its states and words that tell them apart, over the inputs that the new system has, too. Access
// and separating words of an old model are candidates for those of the new one, never facts
// (Ferreira, van Heerdt & Silva, "Tree-based adaptive model learning", A Journey from Process
// Algebra via Timed Automata to Model Learning, 2022).
//
// The old machine is restricted to the common inputs, minimised, and learned by L# itself, which
// costs no query: the observation tree of that run holds the separating words, and an adaptive
// distinguishing sequence for all states is read off it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

class Apartness;

// The machine over those of its inputs that `inputs` has, in that order. O(n k).
Mealy restrict_inputs(const Mealy& machine, const Alphabet& inputs);

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

}  // namespace maide
