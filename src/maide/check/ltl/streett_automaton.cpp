#include "maide/check/ltl/streett_automaton.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

std::size_t StreettAutomaton::most_pairs() const {
  std::size_t most = 0;
  for (const auto& list : pairs) most = std::max(most, list.size());
  return most;
}

namespace {

using Operator = FormulaNode::Operator;

// The operands of a conjunction or disjunction, as deep as it goes; else the formula itself.
void flatten(const Formula& formula, Operator op, std::vector<Formula>& operands) {
  if (formula->op != op) {
    operands.push_back(formula);
    return;
  }
  flatten(formula->left, op, operands);
  flatten(formula->right, op, operands);
}
std::vector<Formula> operands_of(const Formula& formula, Operator op) {
  std::vector<Formula> operands;
  flatten(formula, op, operands);
  return operands;
}

Formula join(const std::vector<Formula>& operands, Operator op) {
  if (operands.empty()) {
    return make_formula(op == Operator::conjunction ? Operator::truth : Operator::falsity);
  }
  Formula joined = operands.front();
  for (std::size_t i = 1; i < operands.size(); ++i) joined = make_formula(op, joined, operands[i]);
  return joined;
}

bool is_constant(const Formula& formula) {
  return formula->op == Operator::truth || formula->op == Operator::falsity;
}

// In negation normal form G p is `false R p`, and F p is `true U p`.
bool is_globally(const Formula& formula) {
  return formula->op == Operator::release && formula->left->op == Operator::falsity;
}
bool is_finally(const Formula& formula) {
  return formula->op == Operator::until && formula->left->op == Operator::truth;
}
Formula globally(const Formula& formula) {
  return make_formula(Operator::release, make_formula(Operator::falsity), formula);
}
Formula finally(const Formula& formula) {
  return make_formula(Operator::until, make_formula(Operator::truth), formula);
}

// The p of G F p, and of F G p; null for other formulas, with p that has temporal operators, and
// with constants.
Formula recurrent(const Formula& formula) {
  if (!is_globally(formula) || !is_finally(formula->right)) return nullptr;
  const Formula inner = formula->right->right;
  return is_boolean(inner) && !is_constant(inner) ? inner : nullptr;
}
Formula persistent(const Formula& formula) {
  if (!is_finally(formula) || !is_globally(formula->right)) return nullptr;
  const Formula inner = formula->right->right;
  return is_boolean(inner) && !is_constant(inner) ? inner : nullptr;
}

// A conjunction, apart: pairs, and what an automaton is made of.
struct Conjunction {
  std::vector<StreettPair> pairs;
  Formula rest;
  bool is_changed = false;  // it is not the formula as it stood
};

// `formula` in negation normal form. F G p && F G q becomes F G (p && q), and G F p || G F q
// becomes G F (p || q), which spare the automaton states.
Conjunction take_apart(const Formula& formula) {
  Conjunction result;
  std::vector<Formula> rest, persisting;
  for (const Formula& operand : operands_of(formula, Operator::conjunction)) {
    std::vector<Formula> recurring, stays;
    bool is_tail = true;  // each alternative is a G F or an F G
    for (const Formula& alternative : operands_of(operand, Operator::disjunction)) {
      const Formula again = recurrent(alternative), always = persistent(alternative);
      if (again) recurring.push_back(again);
      if (always) stays.push_back(always);
      is_tail = is_tail && (again || always);
    }
    if (is_tail && stays.size() == 1 && recurring.empty()) {
      persisting.push_back(stays.front());
    } else if (is_tail && stays.size() == 1) {
      const Formula asked = negation_normal_form(make_formula(Operator::negation, stays.front()));
      result.pairs.push_back({asked, join(recurring, Operator::disjunction)});
    } else if (is_tail && stays.empty() && recurring.size() > 1) {
      rest.push_back(globally(finally(join(recurring, Operator::disjunction))));
      result.is_changed = true;
    } else {
      rest.push_back(operand);
    }
  }
  if (!persisting.empty()) {
    rest.push_back(finally(globally(join(persisting, Operator::conjunction))));
  }
  result.is_changed = result.is_changed || !result.pairs.empty() || persisting.size() > 1;
  result.rest = result.is_changed ? join(rest, Operator::conjunction) : formula;
  return result;
}

// At least as many as the temporal parts of its automaton.
std::size_t count_parts(const Formula& formula) {
  if (!formula || is_constant(formula)) return 0;
  if (formula->op == Operator::atom || formula->op == Operator::negation) return 1;
  const bool is_part = formula->op != Operator::conjunction && formula->op != Operator::disjunction;
  return (is_part ? 1 : 0) + count_parts(formula->left) + count_parts(formula->right);
}

// The disjunction of automata, which stand beside each other.
class Union {
 public:
  void add(const LtlAutomaton& automaton, std::vector<StreettPair> pairs) {
    parts_.push_back({automaton, std::move(pairs)});
  }

  StreettAutomaton take() {
    for (const Part& part : parts_) {
      LtlAutomaton& all = result_.buchi;
      all.mark_count = std::max(all.mark_count, part.automaton.mark_count);
      std::vector<Atom> atoms;
      std::ranges::set_union(all.atoms, part.automaton.atoms, std::back_inserter(atoms));
      all.atoms = std::move(atoms);
    }
    if (result_.buchi.atoms.size() > max_automaton_atoms) {
      throw UsageError("a formula has more than 64 different atoms");
    }
    for (Part& part : parts_) append(part);
    return std::move(result_);
  }

 private:
  struct Part {
    LtlAutomaton automaton;
    std::vector<StreettPair> pairs;
  };

  // The automaton's marks are the first ones; those that others have more lie on all its
  // transitions. There is one universal state.
  void append(Part& part) {
    LtlAutomaton& all = result_.buchi;
    const auto first = static_cast<std::uint32_t>(all.states.size());
    const std::uint64_t others = all.all_marks() & ~part.automaton.all_marks();
    const std::uint32_t universal = part.pairs.empty() ? part.automaton.universal : none;
    const auto number = [&](std::uint32_t state) {
      return state == universal && all.universal != none ? all.universal : first + state;
    };
    for (const auto& transitions : part.automaton.states) {
      auto& own = all.states.emplace_back();
      for (const auto& transition : transitions) {
        own.push_back({moved(transition.letter, part.automaton.atoms), number(transition.target),
                       transition.marks | others});
      }
    }
    for (const std::uint32_t state : part.automaton.initial) all.initial.push_back(number(state));
    if (universal != none && all.universal == none) all.universal = first + universal;
    result_.pairs_of.resize(all.states.size(), static_cast<std::uint32_t>(result_.pairs.size()));
    result_.pairs.push_back(std::move(part.pairs));
  }

  Letter moved(const Letter& letter, const std::vector<Atom>& atoms) const {
    Letter result;
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      const auto place = std::ranges::lower_bound(result_.buchi.atoms, atoms[i]);
      MAIDE_CHECK(place != result_.buchi.atoms.end() && *place == atoms[i]);
      const auto shift = static_cast<unsigned>(place - result_.buchi.atoms.begin());
      result.positive |= (letter.positive >> i & 1) << shift;
      result.negative |= (letter.negative >> i & 1) << shift;
    }
    return result;
  }

  static constexpr std::uint32_t none = LtlAutomaton::no_state;

  std::vector<Part> parts_;
  StreettAutomaton result_;
};

}  // namespace

StreettAutomaton translate_with_pairs(const Formula& formula, const RunControl& control) {
  const Formula normal = negation_normal_form(formula);
  std::vector<Conjunction> apart{take_apart(normal)};
  std::vector<Formula> plain;
  if (!apart.front().is_changed) {
    apart.clear();
    for (const Formula& operand : operands_of(normal, Operator::disjunction)) {
      Conjunction one = take_apart(operand);
      if (one.is_changed) {
        apart.push_back(std::move(one));
      } else {
        plain.push_back(operand);
      }
    }
  }
  const bool is_large =
      plain.size() > 1 && count_parts(join(plain, Operator::disjunction)) > max_temporal_parts;
  StreettAutomaton result;
  if (apart.empty() && !is_large) {
    result.buchi = translate(formula, control);
    return result;
  }
  Union all;
  for (Conjunction& one : apart) all.add(translate(one.rest, control), std::move(one.pairs));
  if (!is_large) plain = {join(plain, Operator::disjunction)};
  for (const Formula& one : plain) {
    if (one->op != Operator::falsity) all.add(translate(one, control), {});
  }
  return all.take();
}

}  // namespace maide
