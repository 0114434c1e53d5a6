#include "maide/learn/counterexample.hpp"

#include <vector>

namespace maide {

std::size_t first_mismatch(const Mealy& hypothesis, const Word& word, const Word& outputs) {
  return first_mismatch(hypothesis, hypothesis.initial(), word, outputs);
}

std::size_t first_mismatch(const Mealy& hypothesis, StateId state, std::span<const Symbol> word,
                           std::span<const Symbol> outputs) {
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (hypothesis.output(state, word[i]) != outputs[i]) return i + 1;
    state = hypothesis.target(state, word[i]);
  }
  return 0;
}

std::vector<StateId> states_along(const Mealy& machine, const Word& word) {
  return states_along(machine, machine.initial(), word);
}

std::vector<StateId> states_along(const Mealy& machine, StateId state, const Word& word) {
  std::vector<StateId> states;
  for (const Symbol input : word) {
    states.push_back(state);
    state = machine.target(state, input);
  }
  return states;
}

Decomposition decompose(const Mealy& hypothesis, std::span<const Word> access,
                        const Word& counterexample, Symbol last_output, OutputOracle& oracle,
                        const RunControl& control) {
  return decompose(states_along(hypothesis, counterexample), access, counterexample, last_output,
                   oracle, control);
}

// Invariant: from access(states[low]) the rest of the word ends in the system's output, from
// access(states[high]) it does not. At 0 it does by definition; at m-1 the output is a fact that
// the hypothesis was built from, and it is wrong for w.
Decomposition decompose(std::span<const StateId> states, std::span<const Word> access,
                        const Word& counterexample, Symbol last_output, OutputOracle& oracle,
                        const RunControl& control) {
  Decomposition result;
  std::size_t low = 0, high = counterexample.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    Word word = access[states[middle]];
    word.insert(word.end(), counterexample.begin() + static_cast<std::ptrdiff_t>(middle),
                counterexample.end());
    ++result.output_queries;
    (oracle.ask(word, control).back() == last_output ? low : high) = middle;
  }
  result.position = low;
  return result;
}

}  // namespace maide
