#include "maide/check/reduction.hpp"

#include "maide/base/error.hpp"
#include "maide/check/silent_steps.hpp"

namespace maide {

std::string to_string(Reduction reduction) {
  switch (reduction) {
    case Reduction::none: return "none";
    case Reduction::order: return "order";
    case Reduction::full: return "full";
  }
  return "";
}

Reduction reduction_of(const std::string& name) {
  for (const Reduction reduction : {Reduction::none, Reduction::order, Reduction::full}) {
    if (to_string(reduction) == name) return reduction;
  }
  throw UsageError("there is no reduction '" + name + "'; there is: none, order, full");
}

ReductionRules rules_for_deadlock() { return {}; }

ReductionRules rules_for_cut() {
  ReductionRules rules;
  rules.puts_nothing_off = true;
  return rules;
}

std::optional<ReductionRules> rules_for_invariant(const System& system, const Property& property) {
  if (!ignores_silent_steps(property.formula)) return std::nullopt;
  ReductionRules rules;
  rules.sets.visible = visible_edges(property.formula, system);
  // A step that cuts the run would end it before what others do.
  rules.sets.cuts_are_visible = true;
  rules.puts_nothing_off = true;
  return rules;
}

std::optional<ReductionRules> rules_for_cycle(const System& system, const Property& property) {
  ReductionRules rules;
  rules.sets.cuts_are_visible = true;
  rules.puts_nothing_off = true;
  if (property.kind == Property::Kind::stuck) {
    rules.sets.watch = Commutation::Watch::weak;
    return rules;
  }
  // What a `never` automaton can see of silent steps is not known.
  if (property.kind == Property::Kind::never) return std::nullopt;
  if (!ignores_silent_steps(property.formula)) return std::nullopt;
  rules.sets.visible = visible_edges(property.formula, system);
  switch (property.fairness) {
    case Fairness::none: break;
    case Fairness::weak: rules.sets.watch = Commutation::Watch::weak; break;
    case Fairness::strong:
      rules.sets.watch = Commutation::Watch::strong;
      rules.sets.singletons = true;
      break;
  }
  return rules;
}

}  // namespace maide
