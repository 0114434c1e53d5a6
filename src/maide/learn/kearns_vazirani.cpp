#include "maide/learn/kearns_vazirani.hpp"

#include "maide/learn/counterexample.hpp"

namespace maide {

// Invariant: the prefix of length `low` is sifted to the hypothesis' state. That of length `high`
// is not, but disagrees with it at node `apart`; or it is the whole word, whose last output is
// wrong.
bool KearnsVazirani::split(const Word& counterexample, std::span<const Symbol> /*outputs*/,
                           const RunControl& control) {
  const std::vector<StateId> states = states_along(hypothesis(), counterexample);
  std::size_t low = 0, high = counterexample.size();
  TreeHypothesis::Node apart = DiscriminationTree::none;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    const Word prefix(counterexample.begin(),
                      counterexample.begin() + static_cast<std::ptrdiff_t>(middle));
    if (const auto node = states_.find_disagreement(prefix, states[middle], control)) {
      high = middle;
      apart = *node;
    } else {
      low = middle;
    }
  }
  DiscriminationTree::Inner inner{{counterexample[low]}, apart};
  if (apart != DiscriminationTree::none) {
    const Word& rest = states_.tree().suffix(apart);
    inner.suffix.insert(inner.suffix.end(), rest.begin(), rest.end());
  }
  // The prefix and the state agree on all that was asked on the way to the leaf.
  const DiscriminationTree& tree = states_.tree();
  for (auto node = tree.leaf(states[low]); node != DiscriminationTree::none;
       node = tree.parent(node)) {
    if (tree.suffix(node) == inner.suffix) return false;
  }
  Word label = states_.known_answer(states[low], counterexample[low], apart);
  states_.split(states[low], std::move(inner), std::move(label));
  return true;
}

}  // namespace maide
