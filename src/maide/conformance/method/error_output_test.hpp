// Equivalence queries where outputs are known to end the session (learn/oracle/error_outputs.hpp).
// Other tests leave out what follows such an output, so two things are left to this one:
//
//   the hypothesis  answers every input behind an error output alike. A word on which it does not
//   is
//                   found without asking
//   the system      does, too. A sample of the words that end the session, drawn by the seed, goes
//                   on with inputs in random order. Where something else comes, the run ends with
//                   the error that says so (ErrorOutputCheck)
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "maide/base/random.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/error_outputs.hpp"

namespace maide {

class ErrorOutputTest : public EquivalenceOracle {
 public:
  // Words of the sample, and inputs behind the end of the session in each, at most.
  static constexpr std::size_t sampled_words = 50, inputs_behind = 20;

  // Keeps references. `tests` are asked between the two parts, through an ErrorAwareOracle on top
  // of `check`.
  ErrorOutputTest(EquivalenceOracle& tests, ErrorOutputCheck& check, std::uint64_t seed)
      : tests_(tests), check_(check), random_(seed) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;
  Strength strength() const override { return tests_.strength(); }
  TestCost cost_of_missing() const override { return tests_.cost_of_missing(); }

 private:
  std::optional<Word> find_unlike(const Mealy& hypothesis);
  std::optional<Word> ask_sample(const Mealy& hypothesis, const RunControl& control);

  EquivalenceOracle& tests_;
  ErrorOutputCheck& check_;
  Random random_;
  std::size_t asked_ = 0;  // words of the last sample
};

}  // namespace maide
