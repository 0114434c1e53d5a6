// The random inputs in the middle of a test. Which of them find what a hypothesis lacks depends on
// how the system hides it, so there are several laws; each test follows one of them, drawn at
// random. No law has to be the right one: each costs the others a constant factor. (A mixture of
// experts, as of Kruger, Junges & Rot, "Small test suites for active automata learning benchmarks",
// 2024, whose experts are subalphabets.)
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/weighted_inputs.hpp"

namespace maide {

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

}  // namespace maide
