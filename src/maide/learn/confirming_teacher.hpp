// Believes no counterexample before the system has shown it twice: the word is asked again, fresh,
// not from the cache. If the two answers differ the cache holds its votes, and if the first one was
// wrong, throws CacheCorrected. One query for each counterexample; none for one that a kept cache
// answers, which the run that asked for it has confirmed.
#pragma once

#include "maide/learn/cache.hpp"
#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

class ConfirmingTeacher : public EquivalenceOracle {
 public:
  // Keeps both references.
  ConfirmingTeacher(EquivalenceOracle& teacher, Cache& cache) : teacher_(teacher), cache_(cache) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override {
    std::optional<Word> counterexample = teacher_.find_counterexample(hypothesis, control);
    if (counterexample && !cache_.is_kept(*counterexample)) {
      cache_.ask_afresh(*counterexample, control);
    }
    return counterexample;
  }
  std::string guarantee() const override { return teacher_.guarantee(); }
  Strength strength() const override { return teacher_.strength(); }
  TestCost cost_of_missing() const override { return teacher_.cost_of_missing(); }

 private:
  EquivalenceOracle& teacher_;
  Cache& cache_;
};

}  // namespace maide
