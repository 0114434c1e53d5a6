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
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

// Draws the infix of a random test: the inputs in its middle. There are several laws, because how
// the system hides something decides which inputs find it. Each test follows one of the laws, drawn
// at random. So no law has to be the right one: each costs the others a constant factor. (A mixture
// of experts, as of Kruger, Junges & Rot, "Small test suites for active automata learning
// benchmarks", 2024, whose experts are subalphabets.)

// Draws an input of a state, each with a weight of its own: Walker's alias method ("An efficient
// method for generating discrete random variables with general distributions", ACM TOMS 1977;
// tables after Vose, IEEE TSE 1991).
class WeightedInputs {
 public:
  // Of each state, then input; positive. There must be an input. O(n k).
  WeightedInputs(std::span<const double> weights, std::size_t input_count);
  // O(1).
  Symbol draw(StateId state, Random& random) const;

 private:
  // One of k equally likely slots of a state: the slot's own input, or another.
  struct Slot {
    std::uint32_t threshold;  // own if 32 random bits are below
    Symbol other;
  };
  std::size_t input_count_;
  std::vector<Slot> slots_;  // by state, then input
};

// Each transition weighs 1 over the number of transitions that lead where it leads. O(n k).
std::vector<double> compute_off_sink_weights(const Mealy& machine);

// Each next state of a state weighs 1 over the number of states that lead to it, shared by the
// transitions that lead there. O(n k).
std::vector<double> compute_off_loop_weights(const Mealy& machine);

// What an infix is drawn from.
enum class InfixInputs : std::uint8_t {
  // For each test another one of the four that follow.
  mixed,
  // Each transition with a weight of 1 over the number of transitions that lead where it leads. So
  // tests seldom enter the states where every wrong input ends, to which most transitions of a
  // protocol lead, and which hide whatever comes after. (OpenSSH's last state is found with 60
  // times fewer inputs than by uniform infixes.)
  off_sinks,
  // Each next state with a weight of 1 over the number of states that lead to it. So tests move
  // where most inputs change nothing: an embedded controller ignores what does not fit.
  off_loops,
  // One to four inputs, drawn for each test, all alike: counters, and what the interplay of a few
  // inputs leads to.
  few,
  // Pieces of the counterexamples so far, from anywhere in them: what a system does in one mode it
  // often does in others.
  replayed,
  uniform,
};

// "mixed", "off-sinks", "off-loops", "few", "replayed", "uniform"; throws UsageError.
InfixInputs find_infix_inputs(std::string_view name);

// At least `min` inputs, and on average `mean` more, geometrically distributed.
struct InfixLaw {
  std::size_t min = 1;
  double mean = 8;
  InfixInputs inputs = InfixInputs::mixed;
};

// Throws UsageError if the law's numbers are negative or above a million.
void check(const InfixLaw& law);

class InfixSampler {
 public:
  // Keeps references, also to the counterexamples to replay, none of which is empty; if there are
  // none, `replayed` is `off_sinks`. O(n k). Throws as check().
  InfixSampler(const Mealy& hypothesis, InfixLaw law, std::span<const Word> counterexamples);

  // Appends an infix to `word`, and takes `state` to where it leads. O(1) an input.
  void draw(StateId& state, Word& word, Random& random) const;

 private:
  std::size_t draw_length(Random& random) const;
  InfixInputs draw_inputs(Random& random) const;

  const Mealy& hypothesis_;
  InfixLaw law_;
  std::span<const Word> counterexamples_;
  double log_going_on_;  // the logarithm of the probability that one more input follows
  std::optional<WeightedInputs> off_sinks_, off_loops_;  // those that the law needs
};

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
