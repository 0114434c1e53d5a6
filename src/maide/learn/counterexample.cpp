#include "maide/learn/counterexample.hpp"

namespace maide {

std::size_t first_mismatch(const Mealy& hypothesis, const Word& word, const Word& outputs) {
  StateId state = hypothesis.initial();
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (hypothesis.output(state, word[i]) != outputs[i]) return i + 1;
    state = hypothesis.target(state, word[i]);
  }
  return 0;
}

// Invariant: from access(w[0..low)) the rest of the word ends in the system's output, from
// access(w[0..high)) it does not. At 0 it does by definition; at m-1 the output is a fact that the
// hypothesis was built from, and it is wrong for w.
Decomposition decompose(const Mealy& hypothesis, std::span<const Word> access,
                        const Word& counterexample, Symbol last_output, OutputOracle& oracle,
                        const RunControl& control) {
  std::vector<StateId> states{hypothesis.initial()};
  for (const Symbol input : counterexample) {
    states.push_back(hypothesis.target(states.back(), input));
  }
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
