// Random tests out of the parts of the complete suites (identifier_suite.hpp): the word that
// reaches a random state, random inputs, and at the end one of the words that identify the state
// where the hypothesis then is (Smeenk, Moerman, Vaandrager & Jansen, ICFEM 2015, for hybrid ADS).
// A complete suite grows with the power of the extra states; this reaches any depth early and is
// never done. Every test has positive probability, so every difference is found in the end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/complete_method.hpp"
#include "maide/conformance/state_identifiers.hpp"
#include "maide/conformance/test_runner.hpp"
#include "maide/conformance/test_suite.hpp"
#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

// Which inputs an infix is drawn from.
enum class InfixInputs : std::uint8_t {
  // Each transition with a weight of 1 over the number of transitions that lead where it leads. So
  // tests seldom enter the states where every wrong input ends, to which most transitions of a
  // protocol lead, and which hide whatever comes after. (OpenSSH's last state is found with 60
  // times fewer inputs than by uniform infixes.)
  off_sinks,
  uniform,
};

// "off-sinks", "uniform"; throws UsageError.
InfixInputs find_infix_inputs(std::string_view name);

// At least `min` inputs, and on average `mean` more, geometrically distributed.
struct InfixLaw {
  std::size_t min = 1;
  double mean = 8;
  InfixInputs inputs = InfixInputs::off_sinks;
};

// Draws the inputs of an infix. O(n k) to make, O(1) to draw: Walker's alias method ("An efficient
// method for generating discrete random variables with general distributions", ACM TOMS 1977;
// tables after Vose, IEEE TSE 1991).
class InfixSampler {
 public:
  InfixSampler(const Mealy& hypothesis, InfixInputs inputs);
  // There must be an input.
  Symbol draw(StateId state, Random& random) const;

 private:
  // One of k equally likely slots of a state: the slot's own input, or another.
  struct Slot {
    std::uint32_t threshold;  // own if 32 random bits are below
    Symbol other;
  };
  std::size_t input_count_;
  std::vector<Slot> slots_;  // by state, then input; empty if uniform
};

class RandomIdentifierSuite : public TestSuite {
 public:
  // Endless. Keeps a reference to `hypothesis`, which must be complete; the identifiers must be its
  // own. Throws UsageError if the law's numbers are negative or above a million.
  RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers, InfixLaw law,
                        Random random);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  std::size_t draw_length();

  const Mealy& hypothesis_;
  StateIdentifiers identifiers_;
  InfixLaw law_;
  double log_going_on_;  // the logarithm of the probability that one more input follows
  InfixSampler sampler_;
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
  // Keeps a reference to `oracle`. Each equivalence query draws new tests. Throws UsageError as the
  // suite does.
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
