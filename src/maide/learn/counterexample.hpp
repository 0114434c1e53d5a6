// The analysis of counterexamples that all learners share. It cuts a counterexample where the
// outputs first differ. It finds a suffix that tells apart two states of the system that are one
// state of the hypothesis (Rivest & Schapire, "Inference of finite automata using homing
// sequences", Information and Computation 103, 1993).
//
// Example: the counterexample is `a b c`, and by `a` the hypothesis goes to the state of the word
// `d`. If the system ends `a b c` and `d b c` with different outputs, `b c` tells the two apart. If
// it does not, the suffix is a shorter one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

// Length of the shortest prefix of `word` on which the hypothesis' outputs are not `outputs`; 0 if
// they agree. Both number outputs alike. O(length).
std::size_t first_mismatch(const Mealy& hypothesis, const Word& word, const Word& outputs);
// The same for a word that begins in `state`.
std::size_t first_mismatch(const Mealy& hypothesis, StateId state, std::span<const Symbol> word,
                           std::span<const Symbol> outputs);

// How a counterexample w of length m decomposes, with u = w[0..position), a = w[position] and v =
// w[position+1..m). The words access(u) a and access(u a) lead the hypothesis to one state, but v
// tells them apart in the system. v is never empty.
struct Decomposition {
  std::size_t position = 0;
  std::uint64_t output_queries = 0;  // asked to find it, at most ceil(log2 m)
};

// Finds one by binary search. `counterexample` is cut at its first mismatch; `last_output` is what
// the system answers to its last input; `access[q]` leads to state q in hypothesis and system.
Decomposition decompose(const Mealy& hypothesis, std::span<const Word> access,
                        const Word& counterexample, Symbol last_output, OutputOracle& oracle,
                        const RunControl& control);

// The same for a word that begins in some state: `states[i]` is the one that the hypothesis is in
// before the input at i.
Decomposition decompose(std::span<const StateId> states, std::span<const Word> access,
                        const Word& counterexample, Symbol last_output, OutputOracle& oracle,
                        const RunControl& control);

// The states that the machine passes along `word`, the last not included. O(length).
std::vector<StateId> states_along(const Mealy& machine, const Word& word);
// The same for a word that begins in `state`.
std::vector<StateId> states_along(const Mealy& machine, StateId state, const Word& word);

}  // namespace maide
