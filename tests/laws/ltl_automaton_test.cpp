// The translation of formulas held against their direct semantics, on random formulas and random
// ultimately periodic runs: the automaton of f accepts exactly the runs on which f holds, and of
// the automata of f and of not-f exactly one accepts each run.
#include "maide/check/ltl_automaton.hpp"

#include <gtest/gtest.h>

#include <array>

#include "maide/base/random.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

Formula make(Operator op, Formula left = nullptr, Formula right = nullptr) {
  FormulaNode node;
  node.op = op;
  node.left = std::move(left);
  node.right = std::move(right);
  return std::make_shared<const FormulaNode>(std::move(node));
}

Formula random_formula(Random& random, int depth) {
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

class RandomFormulas : public testing::TestWithParam<int> {};

TEST_P(RandomFormulas, AreTranslatedRight) {
  Random random(static_cast<std::uint64_t>(7000 + GetParam()));
  int held = 0, failed = 0;
  for (int round = 0; round < 400; ++round) {
    const Formula formula = random_formula(random, 1 + static_cast<int>(random.below(4)));
    const LtlAutomaton automaton = translate(formula);
    const LtlAutomaton complement = translate(make(Operator::negation, formula));
    for (int run = 0; run < 12; ++run) {
      const std::size_t length = 1 + random.below(6);
      const std::size_t loop = random.below(length);
      std::vector<std::uint64_t> truth(length);  // bit: atom's number
      for (std::uint64_t& bits : truth) bits = random.below(8);
      const auto valuations = [&](const LtlAutomaton& of) {
        std::vector<std::uint64_t> result(length);
        for (std::size_t at = 0; at < length; ++at) {
          for (std::size_t i = 0; i < of.atoms.size(); ++i) {
            result[at] |= (truth[at] >> of.atoms[i].symbol & 1) << i;
          }
        }
        return result;
      };
      const bool holds = holds_on_lasso(
          formula, length, loop,
          [&](const Atom& atom, std::size_t at) { return (truth[at] >> atom.symbol & 1) != 0; });
      ++(holds ? held : failed);
      ASSERT_EQ(accepts(automaton, valuations(automaton), loop), holds);
      ASSERT_EQ(accepts(complement, valuations(complement), loop), !holds);
    }
  }
  EXPECT_GT(held, 500);
  EXPECT_GT(failed, 500);
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomFormulas, testing::Range(0, 10));

// GF p0 && ... && GF p(k-1): two states and not 2^k, whatever k is.
TEST(LtlAutomaton, ConjunctionsOfFairnessStaySmall) {
  Formula formula = make(Operator::truth);
  for (std::uint32_t i = 0; i < 8; ++i) {
    FormulaNode node;
    node.op = Operator::atom;
    node.atom.symbol = i;
    const Formula atom = std::make_shared<const FormulaNode>(node);
    formula = make(Operator::conjunction, formula,
                   make(Operator::globally, make(Operator::finally, atom)));
  }
  const LtlAutomaton automaton = translate(formula);
  EXPECT_LE(automaton.states.size(), 2U);
  EXPECT_EQ(automaton.mark_count, 8U);
}

}  // namespace
}  // namespace maide
