// The automaton of a formula with assumptions of fairness, as a search for cycles wants it.
//
// A generalised Buchi automaton of `(G F a -> G F b) && ...` guesses for each of these parts which
// way it is met, and has 2^n states for n of them. Here such a part is a Streett pair: whoever has
// `a` again and again has `b` again and again. Pairs cost no state. A search holds them against
// each strongly connected component that it finds (fair_lasso.hpp), as it does with strong fairness
// (Emerson & Lei, "Modalities for model checking", Sci. Comput. Program. 1987; acceptance beside
// the automaton: Couvreur, Duret-Lutz & Poitrenaud, "On-the-fly emptiness checks for generalized
// Buchi automata", SPIN 2005).
//
// A disjunction is a union: automata beside each other, each with pairs of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/ltl/formula.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"

namespace maide {

// Holds on a run if `asked` is true at finitely many of its positions, or `answered` at infinitely
// many. Both have no temporal operator.
struct StreettPair {
  Formula asked, answered;
};

// A run is accepted if it has a path on which each mark comes again and again, and every pair of
// the path's states holds on the run. All states of a path have the same pairs, for a path does not
// leave its part of the union.
struct StreettAutomaton {
  LtlAutomaton buchi;  // `universal` is a state without pairs
  std::vector<std::vector<StreettPair>> pairs;
  std::vector<std::uint32_t> pairs_of;  // by state: which of `pairs` are its own; empty: no pairs

  std::size_t most_pairs() const;  // of a state
};

// The runs on which the formula holds. Without a part that may be a pair, and without a disjunction
// that is too large for one automaton, it is `translate(formula)`. Throws as that does.
StreettAutomaton translate_with_pairs(const Formula& formula, const RunControl& control = {});

}  // namespace maide
