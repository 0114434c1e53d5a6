#include "maide/check/verdict/vacuity.hpp"

#include <functional>
#include <utility>

#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/ltl/streett_automaton.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

Formula negation_of(const Formula& formula) { return make_formula(Operator::negation, formula); }

class PremiseSearch {
 public:
  std::vector<Premise> find(const Formula& formula) {
    find_in_conjuncts(formula);
    return std::move(premises_);
  }

 private:
  // Each has to hold by itself.
  void find_in_conjuncts(const Formula& formula) {
    if (formula->op == Operator::conjunction) {
      find_in_conjuncts(formula->left);
      find_in_conjuncts(formula->right);
    } else {
      visit(formula, true, [](const Formula& whole) { return whole; });
    }
  }

  // The whole formula, with this in the place of what is visited.
  using Around = std::function<Formula(const Formula&)>;

  void visit(const Formula& formula, bool is_positive, const Around& around) {
    const auto left = [&](bool positive) {
      visit(formula->left, positive, [&](const Formula& inner) {
        return around(make_formula(formula->op, inner, formula->right));
      });
    };
    const auto right = [&](bool positive) {
      visit(formula->right, positive, [&](const Formula& inner) {
        return around(make_formula(formula->op, formula->left, inner));
      });
    };
    switch (formula->op) {
      case Operator::truth:
      case Operator::falsity:
      case Operator::atom:
      case Operator::equivalence: return;
      case Operator::negation: left(!is_positive); return;
      case Operator::implication:
        if (is_positive) {
          premises_.push_back({formula->left, around(negation_of(formula->left))});
          right(true);
        } else {
          left(true);
          right(false);
        }
        return;
      default:
        left(is_positive);
        if (formula->right) right(is_positive);
    }
  }

  std::vector<Premise> premises_;
};

}  // namespace

bool holds_of_everything(const Formula& formula, const RunControl& control) {
  return accepts_nothing(translate_with_pairs(negation_of(formula), control).buchi);
}

std::vector<Premise> premises_of(const Formula& formula) { return PremiseSearch().find(formula); }

}  // namespace maide
