// The translation of formulas held against their direct semantics, on random formulas and random
// ultimately periodic runs: the automaton of f accepts exactly the runs on which f holds, and of
// the automata of f and of not-f exactly one accepts each run. A prefix after which the automaton
// of not-f accepts whatever comes is bad in the direct semantics, too, and no run on which f holds
// has a bad prefix. All of it after the automaton went through the Hanoi Omega-Automata format.
// Automata with pairs are held against the same semantics.
#include "maide/check/ltl/ltl_automaton.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <sstream>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/ltl/streett_automaton.hpp"
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

// A run with positions 0..length-1, of which loop..length-1 repeat for ever.
struct Lasso {
  std::vector<std::uint64_t> truth;  // by position; bit: atom's number
  std::size_t loop = 0;

  bool value(const Atom& atom, std::size_t at) const { return (truth[at] >> atom.symbol & 1) != 0; }
  bool holds(const Formula& formula) const {
    return holds_on_lasso(formula, truth.size(), loop,
                          [this](const Atom& atom, std::size_t at) { return value(atom, at); });
  }
  bool holds_again_and_again(const Formula& formula) const {
    return holds(make(Operator::globally, make(Operator::finally, formula)));
  }
};

// By each part of the union for itself.
bool accepts(const StreettAutomaton& automaton, const Lasso& run) {
  std::vector<std::uint64_t> valuations(run.truth.size());
  for (std::size_t at = 0; at < valuations.size(); ++at) {
    for (std::size_t i = 0; i < automaton.buchi.atoms.size(); ++i) {
      if (run.value(automaton.buchi.atoms[i], at)) valuations[at] |= std::uint64_t{1} << i;
    }
  }
  if (automaton.pairs_of.empty()) return accepts(automaton.buchi, valuations, run.loop);
  for (std::uint32_t part = 0; part < automaton.pairs.size(); ++part) {
    LtlAutomaton buchi = automaton.buchi;
    std::erase_if(buchi.initial,
                  [&](std::uint32_t state) { return automaton.pairs_of[state] != part; });
    const bool has_all = std::ranges::all_of(automaton.pairs[part], [&](const StreettPair& pair) {
      return !run.holds_again_and_again(pair.asked) || run.holds_again_and_again(pair.answered);
    });
    if (has_all && accepts(buchi, valuations, run.loop)) return true;
  }
  return false;
}

// Conditions on what comes again and again, among other formulas.
Formula random_assumption(Random& random) {
  const auto tail = [&] {
    const Formula inner = random_formula(random, random.chance(0.5) ? 0 : 1);
    return random.chance(0.5) ? make(Operator::globally, make(Operator::finally, inner))
                              : make(Operator::finally, make(Operator::globally, inner));
  };
  switch (random.below(5)) {
    case 0: return tail();
    case 1: return random_formula(random, 2);
    case 2: return make(Operator::disjunction, tail(), make(Operator::disjunction, tail(), tail()));
    default: return make(Operator::implication, tail(), tail());
  }
}

TEST(StreettAutomata, AcceptTheRunsOnWhichTheFormulaHolds) {
  Random random(1987);
  int held = 0, failed = 0;
  std::size_t with_pairs = 0, unions = 0;
  for (int round = 0; round < 1000; ++round) {
    Formula formula = random_assumption(random);
    for (std::size_t more = random.below(4); more > 0; --more) {
      const bool either = random.chance(0.3);
      formula = make(either ? Operator::disjunction : Operator::conjunction, formula,
                     random_assumption(random));
    }
    const StreettAutomaton automaton = translate_with_pairs(formula);
    with_pairs += automaton.most_pairs() > 0 ? 1 : 0;
    unions += automaton.pairs.size() > 1 ? 1 : 0;
    for (int i = 0; i < 12; ++i) {
      Lasso run;
      run.truth.resize(1 + random.below(6));
      for (std::uint64_t& bits : run.truth) bits = random.below(8);
      run.loop = random.below(run.truth.size());
      const bool holds = run.holds(formula);
      ++(holds ? held : failed);
      ASSERT_EQ(accepts(automaton, run), holds) << to_string(formula, test::FormulaAtoms().scope());
    }
  }
  EXPECT_GT(held, 2000);
  EXPECT_GT(failed, 2000);
  EXPECT_GT(with_pairs, 150U);
  EXPECT_GT(unions, 30U);
}

Formula atom(std::uint32_t number) {
  Atom atom;
  atom.symbol = number;
  return make_formula(atom);
}

// A formula of n assumptions, G F a -> G F b, has n pairs and no state more than without them; the
// negation of n has n automata beside each other.
TEST(StreettAutomata, AssumptionsCostNoStates) {
  const auto again = [](std::uint32_t number) {
    return make(Operator::globally, make(Operator::finally, atom(number)));
  };
  Formula assumptions = make(Operator::truth);
  for (std::uint32_t i = 0; i < 30; ++i) {
    assumptions = make(Operator::conjunction, assumptions,
                       make(Operator::implication, again(2 * i), again(2 * i + 1)));
    const StreettAutomaton alone = translate_with_pairs(assumptions);
    EXPECT_EQ(alone.most_pairs(), i + 1);
    EXPECT_EQ(alone.buchi.states.size(), 1U);
    const Formula goal = make(Operator::globally, make(Operator::finally, atom(60)));
    const StreettAutomaton with_goal = translate_with_pairs(
        make(Operator::negation, make(Operator::implication, assumptions, goal)));
    EXPECT_EQ(with_goal.most_pairs(), i + 1);
    EXPECT_EQ(with_goal.buchi.states.size(), 2U);
    const StreettAutomaton negation = translate_with_pairs(make(Operator::negation, assumptions));
    EXPECT_LE(negation.buchi.states.size(), 3 * (i + 1));
  }
}

// Ten pairs would take minutes as one automaton.
TEST(LtlAutomaton, TranslationHearsTheDeadline) {
  Formula formula = make(Operator::truth);
  for (std::uint32_t i = 0; i < 10; ++i) {
    const auto again = [](std::uint32_t number) {
      return make(Operator::globally, make(Operator::finally, atom(number)));
    };
    formula = make(Operator::conjunction, formula,
                   make(Operator::implication, again(2 * i), again(2 * i + 1)));
  }
  RunControl control;
  const auto start = std::chrono::steady_clock::now();
  control.deadline = deadline_in(0.2);
  EXPECT_THROW(translate(formula, control), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
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
