// Random tests out of the parts of the complete suites (identifier_suite.hpp): the word that
// reaches a random state, random inputs, and a word that identifies the state where the hypothesis
// then is (Smeenk, Moerman, Vaandrager & Jansen, ICFEM 2015, for hybrid ADS). TestEnds chooses
// other beginnings and ends.
//
// A complete suite grows with the power of the extra states. This one reaches any depth early, and
// is never done. Every test has positive probability, so every difference is found in the end.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/identify/state_identifiers.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/infix_sampler.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

// ---- Beginnings and ends ----
//
// How the state is drawn in which a test begins, and by which word it ends. LearnLib draws states
// and words alike. AALpy can begin in the states that lie far away. Tests of a transition cover
// begin behind a transition.

// Where a test begins.
enum class PrefixStates : std::uint8_t {
  uniform,  // in each state of the hypothesis alike
  // In the farther of two states drawn alike: what was found last mostly lies deep, and behind it
  // what is still to be found.
  deep,
  transitions,  // behind a transition, each alike: a random state's word and a random input
};

// How a test ends.
enum class SuffixWords : std::uint8_t {
  own,   // by a word that identifies the state reached
  any,   // by a word that identifies a random state: other words than a complete suite has there
  none,  // at once: what an infix shows in its own outputs, for the fewest inputs
};

struct TestEnds {
  PrefixStates prefix = PrefixStates::uniform;
  SuffixWords suffix = SuffixWords::own;
};

// "uniform", "deep", "transitions"; throws UsageError that lists them.
PrefixStates find_prefix_states(std::string_view name);
// "own", "any", "none"; likewise.
SuffixWords find_suffix_words(std::string_view name);

class RandomIdentifierSuite : public TestSuite {
 public:
  // Endless. Keeps references to `hypothesis`, which must be complete, and to the counterexamples
  // to replay; the identifiers must be the hypothesis' own. Throws UsageError if the law's numbers
  // are negative or above a million.
  RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers, InfixLaw law,
                        Random random, std::span<const Word> counterexamples = {},
                        TestEnds ends = {});

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  StateId draw_prefix(Word& word);
  void append_suffix(StateId state, Word& word);

  const Mealy& hypothesis_;
  StateIdentifiers identifiers_;
  InfixSampler infixes_;
  Random random_;
  TestEnds ends_;
  std::vector<Word> cover_;       // by length
  std::vector<StateId> reached_;  // by each word of the cover
};

// In words, that the system passed so many of these tests.
std::string describe_passed(std::uint64_t tests, const IdentifierMethod& method,
                            const InfixLaw& law, const TestEnds& ends = {});

struct RandomMethodOptions {
  InfixLaw infix = {};
  TestEnds ends = {};
  std::uint64_t max_tests = 10000;  // in one equivalence query
  std::uint64_t seed = 0;
  std::size_t batch_size = TestRunnerOptions{}.batch_size;
};

class RandomMethod : public SuiteMethod {
 public:
  // Keeps a reference to `oracle`. Each equivalence query draws new tests, which replay pieces of
  // the counterexamples before. Throws UsageError as the suite does.
  RandomMethod(OutputOracle& oracle, const IdentifierMethod& method,
               RandomMethodOptions options = {});

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;

 private:
  IdentifierMethod method_;
  RandomMethodOptions options_;
  Random random_;
  std::vector<Word> counterexamples_;
};

}  // namespace maide
