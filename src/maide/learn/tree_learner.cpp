#include "maide/learn/tree_learner.hpp"

#include <stdexcept>

#include "maide/automata/words.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

void TreeLearner::complete(const RunControl& control) {
  states_.settle(control);
  states_.update();
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
  const Word suffix = tail(word, part.position + 1);
  const auto from = states_.transition(states[part.position], word[part.position]);
  return states_.split(states[part.position + 1], from,
                       {suffix, DiscriminationTree::none, temporary}, control);
}

}  // namespace maide
