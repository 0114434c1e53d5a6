// Which formulas cannot tell whether a run has a few silent steps more: steps that change no label
// of the formula and are none of its events. Only for them may a reduction put a silent step
// elsewhere in a run.
//
// Without X and without events that is so for every formula (Lamport, "What good is temporal
// logic?", 1983: they are insensitive to stuttering). An event holds at one position alone, so that
// a silent step after it can be seen: by `F !m.put`, or by `m.put U m.get`. But `G !m.put`,
// `G F m.put`, `G (m.put -> F m.get)` and their like cannot see it. Asked of the formula's parts:
// how does a part's value at a silent position compare with its values just before and just after?
#pragma once

#include <vector>

#include "maide/check/formula.hpp"
#include "maide/check/system.hpp"

namespace maide {

// True only if inserting silent positions never changes whether the formula holds. Sufficient, not
// necessary; false for a formula with X. O(formula), but for `<->`.
bool ignores_silent_steps(const Formula& formula);

// By program and edge: whether the step may change the value of one of the formula's atoms, or is
// one of its events. All other steps are silent.
std::vector<std::vector<bool>> visible_edges(const Formula& formula, const System& system);

}  // namespace maide
