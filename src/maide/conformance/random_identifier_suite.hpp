// Random tests out of the parts of the complete suites (identifier_suite.hpp): the word that
// reaches a random state, random inputs, and at the end one of the words that identify the state
// where the hypothesis then is (Smeenk, Moerman, Vaandrager & Jansen, ICFEM 2015, for hybrid ADS).
// A complete suite grows with the power of the extra states; this reaches any depth early and is
// never done. Every test has positive probability, so every difference is found in the end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/complete_method.hpp"
#include "maide/conformance/state_identifiers.hpp"
#include "maide/conformance/test_runner.hpp"
#include "maide/conformance/test_suite.hpp"
#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

// How many inputs lie between access word and identifier: at least `min`, and on average `mean`
// more, geometrically distributed.
struct InfixLaw {
  std::size_t min = 1;
  double mean = 4;
};

class RandomIdentifierSuite : public TestSuite {
 public:
  // Endless. Keeps a reference to `hypothesis`, which must be complete; the identifiers must be its
  // own. The law must be possible: mean >= 0.
  RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers, InfixLaw law,
                        Random random);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  const Mealy& hypothesis_;
  StateIdentifiers identifiers_;
  InfixLaw law_;
  double stop_probability_;  // before each input beyond the least
  Random random_;
  std::vector<Word> cover_;
  std::vector<StateId> reached_;  // by each word of the cover
};

struct RandomMethodOptions {
  InfixLaw infix = {};
  std::uint64_t max_tests = 10000;  // in one equivalence query
  std::uint64_t seed = 0;
  std::size_t batch_size = TestRunnerOptions{}.batch_size;
};

class RandomMethod : public EquivalenceOracle {
 public:
  // Keeps a reference to `oracle`. Each equivalence query draws new tests. Throws UsageError if the
  // mean of the infix is negative or no number.
  RandomMethod(OutputOracle& oracle, const IdentifierMethod& method,
               RandomMethodOptions options = {});

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override { return guarantee_; }

 private:
  TestRunner runner_;
  IdentifierMethod method_;
  InfixLaw law_;
  Random random_;
  std::string guarantee_ = "not tested";
};

}  // namespace maide
