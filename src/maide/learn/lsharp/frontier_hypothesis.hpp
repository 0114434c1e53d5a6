// The hypothesis of L#, and where it contradicts the observation tree; both are kept up to date. A
// state of the basis is the state of the hypothesis with the same number. A transition to the
// frontier leads to the one candidate of its node.
//
// The hypothesis agrees with the tree if it answers from the candidate what was asked from the
// frontier node. That is the same for all nodes of a class (frontier_classes.hpp). So a class is
// checked, and checked again only if the class, or a transition that it was checked along, has
// changed.
#pragma once

#include <optional>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/lsharp/apartness.hpp"

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

  // Throws std::logic_error unless the hypothesis agrees with the whole observation tree: so
  // between two equivalence queries. O(tree).
  void check_invariants(const Apartness& apartness) const;

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
