#include "maide/check/reduce/reduction.hpp"

#include <algorithm>
#include <cstdint>

#include "maide/check/system/atom_view.hpp"

namespace maide {

std::optional<CallRules> rules_for_calls(const System& system, const Property& property) {
  CallRules rules;
  // What a `never` automaton can see of silent steps is not known.
  if (property.kind == Property::Kind::never) return std::nullopt;
  if (property.kind == Property::Kind::ltl) {
    if (!ignores_silent_steps(property.formula)) return std::nullopt;
    rules.visible = visible_edges(property.formula, system);
    rules.is_fair = property.fairness != Fairness::none && !invariant_of(property);
  }
  if (property.kind == Property::Kind::stuck) rules.is_fair = true;
  return rules;
}

Formula invariant_of(const Property& property) {
  if (property.kind != Property::Kind::ltl) return nullptr;
  const Formula& formula = property.formula;
  if (formula->op != FormulaNode::Operator::globally) return nullptr;
  return is_boolean(formula->left) ? formula->left : nullptr;
}

ReductionRules rules_for_deadlock() { return {}; }

ReductionRules rules_for_cut() {
  ReductionRules rules;
  rules.puts_nothing_off = true;
  return rules;
}

ReductionRules rules_for_error() {
  ReductionRules rules;
  // A step that cuts the run would end it before what others do.
  rules.sets.cuts_are_visible = true;
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

namespace {

void treat_fairly(Fairness fairness, StubbornOptions& sets) {
  switch (fairness) {
    case Fairness::none: break;
    case Fairness::weak: sets.watch = Commutation::Watch::weak; break;
    case Fairness::strong:
      sets.watch = Commutation::Watch::strong;
      sets.one_can_step = true;
      break;
  }
}

}  // namespace

std::optional<ReductionRules> rules_for_cycle(const System& system, const Property& property) {
  ReductionRules rules;
  rules.sets.cuts_are_visible = true;
  rules.puts_nothing_off = true;
  if (property.kind == Property::Kind::stuck) {
    treat_fairly(property.fairness, rules.sets);
    return rules;
  }
  // What a `never` automaton can see of silent steps is not known.
  if (property.kind == Property::Kind::never) return std::nullopt;
  if (!ignores_silent_steps(property.formula)) return std::nullopt;
  rules.sets.visible = visible_edges(property.formula, system);
  treat_fairly(property.fairness, rules.sets);
  return rules;
}

namespace {

// What is known of a formula's value s at a silent position, between the positions before and after
// with values b and a.
struct Silence {
  bool is_false = false, is_true = false;                // s is always so
  bool at_most_before = false, at_most_after = false;    // s <= b, s <= a
  bool at_least_before = false, at_least_after = false;  // s >= b, s >= a
  bool is_ignored = true;  // the value elsewhere does not depend on silent positions

  void use_constants() {
    at_most_before = at_most_before || is_false;
    at_most_after = at_most_after || is_false;
    at_least_before = at_least_before || is_true;
    at_least_after = at_least_after || is_true;
  }
};

Silence of_constant(bool value) {
  Silence result;
  (value ? result.is_true : result.is_false) = true;
  result.at_most_before = result.at_most_after = true;
  result.at_least_before = result.at_least_after = true;
  return result;
}

Silence of_literal(const Atom& atom, bool is_negated) {
  Silence result;
  if (atom.is_event()) {
    (is_negated ? result.is_true : result.is_false) = true;
  } else {
    result.at_most_before = result.at_least_before = true;
  }
  result.use_constants();
  return result;
}

Silence of_boolean(const Silence& left, const Silence& right, bool is_conjunction) {
  Silence result;
  result.is_false =
      is_conjunction ? left.is_false || right.is_false : left.is_false && right.is_false;
  result.is_true = is_conjunction ? left.is_true && right.is_true : left.is_true || right.is_true;
  result.at_most_before = left.at_most_before && right.at_most_before;
  result.at_most_after = left.at_most_after && right.at_most_after;
  result.at_least_before = left.at_least_before && right.at_least_before;
  result.at_least_after = left.at_least_after && right.at_least_after;
  result.is_ignored = left.is_ignored && right.is_ignored;
  result.use_constants();
  return result;
}

// left U right: at a silent position, right or (left and the value after).
Silence of_until(const Silence& left, const Silence& right) {
  Silence result;
  result.is_ignored = left.is_ignored && right.is_ignored && left.at_least_before &&
                      (right.at_most_before || right.at_most_after);
  result.is_true = right.is_true;
  result.at_most_before = left.at_most_before && right.at_most_before;
  result.at_most_after = right.at_most_after;
  result.at_least_before = left.at_least_before && right.at_least_before;
  result.at_least_after = left.is_true || (left.at_least_after && right.at_least_after);
  result.use_constants();
  return result;
}

Silence negated(Silence silence) {
  std::swap(silence.is_false, silence.is_true);
  std::swap(silence.at_most_before, silence.at_least_before);
  std::swap(silence.at_most_after, silence.at_least_after);
  return silence;
}

// `formula` is in negation normal form.
Silence silence_of(const Formula& formula) {
  using Operator = FormulaNode::Operator;
  const auto left = [&] { return silence_of(formula->left); };
  const auto right = [&] { return silence_of(formula->right); };
  switch (formula->op) {
    case Operator::truth: return of_constant(true);
    case Operator::falsity: return of_constant(false);
    case Operator::atom: return of_literal(formula->atom, false);
    case Operator::negation: return of_literal(formula->left->atom, true);
    case Operator::conjunction: return of_boolean(left(), right(), true);
    case Operator::disjunction: return of_boolean(left(), right(), false);
    case Operator::until: return of_until(left(), right());
    case Operator::release: return negated(of_until(negated(left()), negated(right())));
    default: break;
  }
  Silence unknown;  // X
  unknown.is_ignored = false;
  return unknown;
}

}  // namespace

bool ignores_silent_steps(const Formula& formula) {
  return silence_of(negation_normal_form(formula)).is_ignored;
}

std::vector<std::vector<bool>> visible_edges(const Formula& formula, const System& system) {
  const std::vector<AtomView> views = views_of(atoms_of(formula), system);
  std::vector<std::vector<bool>> visible;
  const auto add = [&](std::uint32_t actor, std::size_t actions) {
    std::vector<bool>& here = visible.emplace_back();
    for (std::uint32_t i = 0; i < actions; ++i) here.push_back(is_visible(views, actor, i));
  };
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    add(index, system.programs[index].edges.size());
  }
  if (!system.nobodys_actions.empty()) add(nobody, system.nobodys_actions.size());
  return visible;
}

}  // namespace maide
