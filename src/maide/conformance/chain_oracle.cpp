#include "maide/conformance/chain_oracle.hpp"

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

}  // namespace maide
