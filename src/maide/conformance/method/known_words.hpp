// Words that are known to matter, as tests. `KnownWords` tests counterexamples from elsewhere, such
// as a model checker or a run that was ended, before anything else. `choose_confirmation_words()`
// chooses words that show again what a learned model rests on.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"

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

// ---- Confirmation ----
//
// A few words that show again, one by one, what a learned model rests on: each state, told from the
// others, and each transition, with a word that identifies where it leads. They are for a second
// look at the system under other conditions, not for finding new states.

// State cover with a characterising set, transition cover with a word of it drawn for each
// transition; no word is a prefix of another. Of these a sample of at most `most_symbols` inputs in
// all, but at least one word. `model` must be complete; the same seed gives the same words.
std::vector<Word> choose_confirmation_words(const Mealy& model, std::uint64_t seed,
                                            std::uint64_t most_symbols);

}  // namespace maide
