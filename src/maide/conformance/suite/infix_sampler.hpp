// Draws the infix of a random test: the inputs in its middle. There are several laws, because how
// the system hides something decides which inputs find it. Each test follows one of the laws, drawn
// at random. So no law has to be the right one: each costs the others a constant factor. (A mixture
// of experts, as of Kruger, Junges & Rot, "Small test suites for active automata learning
// benchmarks", 2024, whose experts are subalphabets.)
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"

namespace maide {

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

}  // namespace maide
