// Words that tell states apart, the shortest there are. `SeparatingWords` keeps the splits by which
// the classes of states are found level by level (automata/minimize.hpp), as a tree (Smetsers,
// Moerman & Jansen, "Minimal separating sequences for all pairs of states", LATA 2016).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide {

class SeparatingWords {
 public:
  // Keeps a reference to `machine`, which must be complete. O(n k log n) time, O(n k) memory.
  explicit SeparatingWords(const Mealy& machine);

  // Number of classes of states that no word tells apart: the size of the minimal machine.
  std::size_t class_count() const { return class_count_; }
  // Some word tells them apart. O(1).
  bool are_separable(StateId left, StateId right) const { return leaf_[left] != leaf_[right]; }
  // A shortest word to which they answer differently, at the last input; nothing if equivalent.
  std::optional<Word> find(StateId left, StateId right) const;

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  // Inner nodes of the splitting tree: states below different children are told apart by `input`,
  // by its output or by what follows.
  struct Node {
    std::uint32_t parent = none;
    std::uint32_t depth = 0;
    Symbol input = 0;
  };
  Symbol splitting_input(StateId left, StateId right) const;

  const Mealy& machine_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_;  // the leaf of each state
  std::size_t class_count_ = 0;
};

// A characterising set: for every two states that are not equivalent, a word in it tells them
// apart. Words are shortest for some pair, taken only while they split what the others do not, and
// none is a prefix of another; sorted by length, then alphabet. Empty if all states are equivalent.
// O(|W| n l) for words of length l. `separating` is the machine's.
std::vector<Word> compute_characterising_set(const Mealy& machine,
                                             const SeparatingWords& separating);

// For each state a shortest (then alphabet-least) word that leads there: prefix-closed, in
// breadth-first order; the words of unreachable states are left out. O(n k).
std::vector<Word> compute_state_cover(const Mealy& machine);

}  // namespace maide
