#include "maide/conformance/chain_oracle.hpp"

#include <algorithm>

namespace maide {

std::optional<Word> ChainOracle::find_counterexample(const Mealy& hypothesis,
                                                     const RunControl& control) {
  for (const auto& link : links_) {
    if (auto counterexample = link->find_counterexample(hypothesis, control)) {
      return counterexample;
    }
  }
  return std::nullopt;
}

std::string ChainOracle::guarantee() const {
  std::string text;
  for (const auto& link : links_) text += (text.empty() ? "" : "; ") + link->guarantee();
  return text;
}

Strength ChainOracle::strength() const {
  Strength all;
  for (const auto& link : links_) {
    const Strength one = link->strength();
    all.exact = all.exact || one.exact;
    all.extra_states = std::max(all.extra_states, one.extra_states);
    all.chained = std::max(all.chained, one.chained);
    all.pumped = std::max(all.pumped, one.pumped);
    all.random += one.random;
  }
  return all;
}

TestCost ChainOracle::cost_of_missing() const {
  TestCost most;
  for (const auto& link : links_) {
    const TestCost one = link->cost_of_missing();
    if (one.words > most.words) most = one;
  }
  return most;
}

}  // namespace maide
