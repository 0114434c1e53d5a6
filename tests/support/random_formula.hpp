// Random formulas of temporal logic over three atoms, and what their atoms are called.
#pragma once

#include <array>
#include <utility>

#include "maide/base/random.hpp"
#include "maide/check/ltl/formula.hpp"

namespace maide::test {

inline Formula make(FormulaNode::Operator op, Formula left = nullptr, Formula right = nullptr) {
  FormulaNode node;
  node.op = op;
  node.left = std::move(left);
  node.right = std::move(right);
  return std::make_shared<const FormulaNode>(std::move(node));
}

inline Formula random_formula(Random& random, int depth) {
  using Operator = FormulaNode::Operator;
  if (depth == 0 || random.chance(0.15)) {
    if (random.chance(0.1)) return make(random.chance(0.5) ? Operator::truth : Operator::falsity);
    FormulaNode node;
    node.op = Operator::atom;
    node.atom.symbol = static_cast<std::uint32_t>(random.below(3));
    return std::make_shared<const FormulaNode>(std::move(node));
  }
  constexpr std::array unary{Operator::negation, Operator::next, Operator::finally,
                             Operator::globally};
  constexpr std::array binary{Operator::conjunction, Operator::disjunction, Operator::implication,
                              Operator::equivalence, Operator::until,       Operator::release,
                              Operator::weak_until};
  if (random.chance(0.45)) {
    return make(unary[random.below(unary.size())], random_formula(random, depth - 1));
  }
  return make(binary[random.below(binary.size())], random_formula(random, depth - 1),
              random_formula(random, depth - 1));
}

// The atoms are the labels p@a0, p@a1, ... of one program.
class FormulaAtoms {
 public:
  FormulaAtoms() {
    programs_[0].name = "p";
    for (int i = 0; i < 8; ++i) programs_[0].labels.push_back("a" + std::to_string(i));
  }
  FormulaScope scope() const { return {programs_, {}}; }

 private:
  std::array<Program, 1> programs_;
};

}  // namespace maide::test
