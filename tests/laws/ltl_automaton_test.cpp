// The translation of formulas held against their direct semantics, on random formulas and random
// ultimately periodic runs: the automaton of f accepts exactly the runs on which f holds, and of
// the automata of f and of not-f exactly one accepts each run. A prefix after which the automaton
// of not-f accepts whatever comes is bad in the direct semantics, too, and no run on which f holds
// has a bad prefix. All of it after the automaton went through the Hanoi Omega-Automata format.
#include "maide/check/ltl/ltl_automaton.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "random_formula.hpp"

namespace maide {
namespace {

using test::make;
using test::random_formula;
using Operator = FormulaNode::Operator;

// Through the text and back: what is read is what was written.
LtlAutomaton read_back(const LtlAutomaton& automaton) {
  const test::FormulaAtoms atoms;
  std::ostringstream text;
  write_hoa(text, automaton, atoms.scope(), "");
  LtlAutomaton read = read_hoa(text.str(), "f.hoa", atoms.scope());
  EXPECT_EQ(read, automaton) << text.str();
  return read;
}

class RandomFormulas : public testing::TestWithParam<int> {};

TEST_P(RandomFormulas, AreTranslatedRight) {
  Random random(static_cast<std::uint64_t>(7000 + GetParam()));
  int held = 0, failed = 0, bad_prefixes = 0;
  for (int round = 0; round < 400; ++round) {
    const Formula formula = random_formula(random, 1 + static_cast<int>(random.below(4)));
    const LtlAutomaton automaton = read_back(translate(formula));
    const LtlAutomaton complement = read_back(translate(make(Operator::negation, formula)));
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
      const auto value = [&](const Atom& atom, std::size_t at) {
        return (truth[at] >> atom.symbol & 1) != 0;
      };
      const bool holds = holds_on_lasso(formula, length, loop, value);
      ++(holds ? held : failed);
      ASSERT_EQ(accepts(automaton, valuations(automaton), loop), holds);
      ASSERT_EQ(accepts(complement, valuations(complement), loop), !holds);
      const std::size_t cut = random.below(length);
      const bool may_hold = holds_on_lasso(formula, length, loop, value, cut);
      ASSERT_TRUE(may_hold || !holds);
      std::vector<std::uint64_t> prefix = valuations(complement);
      prefix.resize(cut);
      if (!accepts_whatever_comes(complement, prefix)) continue;
      ++bad_prefixes;
      ASSERT_FALSE(may_hold) << to_string(formula, test::FormulaAtoms().scope());
    }
  }
  EXPECT_GT(held, 500);
  EXPECT_GT(failed, 500);
  EXPECT_GT(bad_prefixes, 100);
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
