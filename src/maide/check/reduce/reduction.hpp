// Reductions: which parts of a system's graph may be left out when a property is asked of it, and
// what a search must respect then. Here are the rules for each kind of property, and the test
// whether a formula can see silent steps. docs/design/reductions.md says why the rules are right.
//
// Example: `F p@sent` is true or false however many silent steps come before the label, so these
// may be left out. `X p@sent` is not: it asks of the step that comes first.
#pragma once

#include <optional>
#include <vector>

#include "maide/check/ltl/formula.hpp"
#include "maide/check/reduce/stubborn_sets.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// What a search must respect when it takes the steps of stubborn sets only.
struct ReductionRules {
  StubbornOptions sets;
  bool puts_nothing_off = false;  // steps that are left out are taken in some later state
};

// `G condition`: the condition, which a finite run can violate; null if the property is no such.
Formula invariant_of(const Property& property);

// What a property demands where an input and its answer are made one step.
struct CallRules {
  // By program and edge: the formula can see the step. Empty: it sees none.
  std::vector<std::vector<bool>> visible;
  bool is_fair = false;  // the property is about fair runs
};

// Nothing if the formula could see where silent steps lie.
std::optional<CallRules> rules_for_calls(const System& system, const Property& property);

ReductionRules rules_for_deadlock();
// For a run that leaves what was learned.
ReductionRules rules_for_cut();
// For a run that comes to an error.
ReductionRules rules_for_error();
// Nothing if the formula could see where silent steps lie: then all is taken.
std::optional<ReductionRules> rules_for_invariant(const System& system, const Property& property);
// For `stuck`, or a formula with the property's fairness. Nothing where all is taken.
std::optional<ReductionRules> rules_for_cycle(const System& system, const Property& property);

// ---- Silent steps ----
//
// A silent step changes no label of the formula and is none of its events. A reduction may put a
// silent step elsewhere in a run only if the formula cannot tell whether a run has a few silent
// steps more.
//
// Without X and without events every formula is like that (Lamport, "What good is temporal logic?",
// 1983: insensitive to stuttering). An event holds at one position alone, so a silent step after it
// can be seen: by `F !m.put`, or by `m.put U m.get`. But `G !m.put`, `G F m.put`, `G (m.put -> F
// m.get)` and their like cannot see it. Each part of the formula is asked: how does its value at a
// silent position compare with its values just before and just after?

// True only if inserting silent positions never changes whether the formula holds. Sufficient, not
// necessary; false for a formula with X. O(formula), but for `<->`.
bool ignores_silent_steps(const Formula& formula);

// By actor and action, nobody last, if he has any: whether the step may change the value of one of
// the formula's atoms, or is one of its events. All other steps are silent.
std::vector<std::vector<bool>> visible_edges(const Formula& formula, const System& system);

}  // namespace maide
