// Formulas that hold, but say nothing of a system. A formula may be true of every run of
// everything. An implication in it may be true because what stands before the arrow never is: then
// the formula holds just as well with `false` behind the arrow (Beer, Ben-David, Eisner & Rodeh,
// "Efficient detection of vacuity in temporal model checking", FMSD 2001; Kupferman & Vardi,
// "Vacuity detection in temporal model checking", STTT 2003).
#pragma once

#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/ltl/formula.hpp"

namespace maide {

// Whether it holds on every run, whatever its atoms are. True is right; false may only be unknown,
// of formulas with assumptions of fairness. Throws as translate() does.
bool holds_of_everything(const Formula& formula, const RunControl& control);

// An implication of a formula, where the formula is the weaker the weaker it is.
struct Premise {
  Formula premise;
  // The formula, or the conjunct of it where the premise stands, if nothing follows from the
  // premise. Where the formula holds, this holds exactly if the premise never matters.
  Formula denied;
};

// From left to right; none inside of another's premise, or of `<->`.
std::vector<Premise> premises_of(const Formula& formula);

}  // namespace maide
