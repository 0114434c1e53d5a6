// The hypothesis of L#, and where it contradicts the observation tree, both kept up to date: a
// state of the basis is a state of the hypothesis, of the same number, and a transition to the
// frontier leads to the one candidate of its node.
//
// What was asked from a frontier node must be what the hypothesis answers from the candidate. That
// is the same for all nodes of a class (frontier_classes.hpp), so a class is checked, and again
// only if it or a transition that it was checked along has changed.
#pragma once

#include <optional>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/apartness.hpp"

namespace maide {

class FrontierHypothesis {
 public:
  // Without states before the first update().
  const Mealy& machine() const { return machine_; }

  // Every input was asked in every state of the basis, and every frontier node has one candidate.
  // O(changes since the last update).
  void update(Apartness& apartness, const Alphabet& inputs, const Alphabet& outputs);

  // A shortest word in the tree whose last output is not the hypothesis', which is up to date.
  std::optional<Word> find_conflict(const Apartness& apartness);

 private:
  using Class = FrontierClasses::Class;
  using Transition = Apartness::Transition;

  void set_target(Transition transition, const Apartness& apartness);
  void check_again(Class at);
  std::size_t check(Class at, const Apartness& apartness);
  void note_use(Transition transition, Class at);

  Mealy machine_;
  std::vector<Class> unchecked_;
  std::vector<bool> is_unchecked_;         // by class
  std::vector<std::vector<Class>> users_;  // by transition: classes that were checked along it
};

}  // namespace maide
