#include "maide/learn/tree/tree_learners.hpp"

#include <stdexcept>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

void TreeLearner::complete(const RunControl& control) {
  states_.settle(control);
  states_.update();
}

void TreeLearner::check_invariants() const {
  states_.check_invariants();
  const DiscriminationTree& tree = states_.tree();
  MAIDE_CHECK_ALWAYS(hypothesis().size() == states_.size());
  for (StateId state = 0; state < states_.size(); ++state) {
    MAIDE_CHECK_ALWAYS(hypothesis().run(states_.access(state)) == state);
    for (auto node = tree.leaf(state); node != DiscriminationTree::none; node = tree.parent(node)) {
      MAIDE_CHECK_ALWAYS(!tree.is_temporary(node));
    }
  }
}

void TreeLearner::refine(const Word& counterexample, const RunControl& control) {
  ++counterexample_queries_;
  const Word outputs = oracle_.ask(counterexample, control);
  if (first_mismatch(hypothesis(), counterexample, outputs) == 0) {
    throw std::invalid_argument("the hypothesis agrees with the system on this word");
  }
  complete(control);  // what an interruption left
  if (!split_at_mismatch(counterexample, outputs, control)) return;
  complete(control);
  restructure(control);
  while (split_at_mismatch(counterexample, outputs, control)) complete(control);
}

bool TreeLearner::split_at_mismatch(const Word& word, const Word& outputs,
                                    const RunControl& control) {
  const std::size_t length = first_mismatch(hypothesis(), word, outputs);
  if (length == 0) return false;
  const Word cut = head(word, length);
  if (!split(cut, outputs, control)) {
    throw NondeterminismError(to_string(cut, oracle_.inputs()),
                              to_string(hypothesis().output_word(cut), oracle_.outputs()),
                              to_string(std::span(outputs).first(length), oracle_.outputs()));
  }
  return true;
}

bool TreeLearner::split_by_suffix(std::span<const StateId> states, const Word& word,
                                  Symbol last_output, bool temporary, const RunControl& control) {
  if (word.size() < 2) return false;  // an output that the machine was made from
  const Decomposition part =
      decompose(states, states_.access(), word, last_output, oracle_, control);
  counterexample_queries_ += part.output_queries;
  MAIDE_CHECK(part.position + 1 < word.size());  // so the suffix is not empty
  const Word suffix = tail(word, part.position + 1);
  const auto from = states_.transition(states[part.position], word[part.position]);
  return states_.split(states[part.position + 1], from,
                       {suffix, DiscriminationTree::none, temporary}, control);
}

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
  MAIDE_CHECK(low + 1 == high || counterexample.size() == 1);
  MAIDE_CHECK((apart == DiscriminationTree::none) == (high == counterexample.size()));
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

bool ObservationPack::split(const Word& counterexample, std::span<const Symbol> outputs,
                            const RunControl& control) {
  return split_by_suffix(states_along(hypothesis(), counterexample), counterexample,
                         outputs[counterexample.size() - 1], false, control);
}

}  // namespace maide
