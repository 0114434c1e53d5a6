// Words that somebody knows to matter, as a test: counterexamples that came from elsewhere (a model
// checker, a run that was ended) and that each hypothesis must get right before anything else is
// tested.
#pragma once

#include <vector>

#include "maide/conformance/test_runner.hpp"
#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

class KnownWords : public EquivalenceOracle {
 public:
  // Keeps a reference to `oracle`.
  KnownWords(OutputOracle& oracle, std::vector<Word> words)
      : runner_(oracle, {}), words_(std::move(words)) {}

  // One output query a word.
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;

 private:
  TestRunner runner_;
  std::vector<Word> words_;
};

}  // namespace maide
