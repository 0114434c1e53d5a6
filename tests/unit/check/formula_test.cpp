#include "maide/check/ltl/formula.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "maide/base/random.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

class FormulaTest : public testing::Test {
 protected:
  FormulaTest()
      : system_(test::system_of("  p: '@a via.write; @b via.write;'\n  F: via.read;\n")),
        interfaces_(system_.interfaces()) {}
  FormulaScope scope() const { return {system_.programs, interfaces_}; }
  Formula parse(const std::string& text) const {
    return parse_formula(ScalarText(text, text, {"f", 1, 1}), scope());
  }
  std::string shown(const std::string& text) const { return to_string(parse(text), scope()); }
  std::string error(const std::string& text) const {
    return test::error_of([&] { parse(text); });
  }
  System system_;
  std::vector<ProgramInterface> interfaces_;
};

TEST_F(FormulaTest, Precedence) {
  EXPECT_EQ(shown("G p@a -> F via!message"), "(G p@a -> F via!message)");
  EXPECT_EQ(shown("[]!via!message && <>p@end"), "(G !via!message && F p@end)");
  EXPECT_EQ(shown("p@a U p@b U p@end"), "(p@a U (p@b U p@end))");
  EXPECT_EQ(shown("p@a | p@b & p@end W via.write"), "(p@a || (p@b && (p@end W via.write)))");
  EXPECT_EQ(shown("true -> false -> p@a <-> p@b"), "((true -> (false -> p@a)) <-> p@b)");
  EXPECT_EQ(shown("!!X p@a R \"p\"@\"b\""), "(!!X p@a R p@b)");
}

TEST_F(FormulaTest, OperatorsAndNames) {
  EXPECT_EQ(shown("F !via!message"), "F !via!message");
  EXPECT_EQ(shown("F@end"), "\"F\"@end");  // a program's name before @
  EXPECT_EQ(shown("F F@end"), "F \"F\"@end");
}

TEST_F(FormulaTest, ErrorsNameThePlace) {
  EXPECT_EQ(error("G ("), "expected a formula, not the end of the text (f:1:4)");
  EXPECT_EQ(error("(p@a"), "expected ')' for this '(', not the end of the text at f:1:5 (f:1:1)");
  EXPECT_EQ(error("p@a p@b"), "expected an operator, not 'p' (f:1:5)");
  EXPECT_EQ(error("p"),
            "expected program@label, model.input or model!output, not 'p' alone: no variable, "
            "constant or word has this name (f:1:1)");
  EXPECT_EQ(error("p@c"), "program p has no label 'c'; it has: a, b, end (f:1:3)");
  EXPECT_EQ(error("q@a"), "unknown program 'q'; there is: p, F (f:1:1)");
  EXPECT_EQ(error("via.wirte"),
            "model via has no input 'wirte'; it has: write, read; did you mean 'write'? (f:1:5)");
  EXPECT_EQ(error("p!x"), "unknown model 'p'; there is: via, sync (f:1:1)");
  EXPECT_EQ(error("p@a)"), "this ')' closes nothing (f:1:4)");
  EXPECT_NE(error(std::string(100000, '(')).find("too deeply"), std::string::npos);
  EXPECT_NE(error(std::string(100000, '!')).find("too deeply"), std::string::npos);
  std::string wide = "p@a";
  for (int count = 0; count < 5000; ++count) wide += " && p@a";
  EXPECT_NE(error(wide).find("too large"), std::string::npos);
  std::string doubling = "p@a";
  for (int count = 0; count < 40; ++count) doubling += " <-> p@a";
  EXPECT_NE(error(doubling).find("too large"), std::string::npos);
}

TEST_F(FormulaTest, Classes) {
  EXPECT_TRUE(is_boolean(parse("p@a -> !p@b <-> true")));
  EXPECT_FALSE(is_boolean(parse("p@a -> G p@b")));
  EXPECT_TRUE(is_syntactically_safe(parse("G (p@a -> (p@b W p@end))")));
  EXPECT_TRUE(is_syntactically_safe(parse("!F p@a")));
  EXPECT_FALSE(is_syntactically_safe(parse("G F p@a")));
}

// The bit of a letter that an atom stands for.
unsigned bit(const Atom& atom) { return atom.kind == Atom::Kind::end ? 2 : atom.symbol; }

// A random formula over p@a, p@b, p@end.
Formula random_formula(Random& random, int depth) {
  const auto node = [](Operator op, Formula left, Formula right) {
    return std::make_shared<FormulaNode>(FormulaNode{op, {}, std::move(left), std::move(right)});
  };
  if (depth == 0 || random.chance(0.1)) {
    auto atom = std::make_shared<FormulaNode>(FormulaNode{Operator::atom, {}, nullptr, nullptr});
    const auto which = static_cast<std::uint32_t>(random.below(3));
    atom->atom = which == 2 ? Atom{Atom::Kind::end, 0, 0} : Atom{Atom::Kind::label, 0, which};
    return atom;
  }
  const Operator ops[] = {Operator::negation,    Operator::next,        Operator::finally,
                          Operator::globally,    Operator::conjunction, Operator::disjunction,
                          Operator::implication, Operator::equivalence, Operator::until,
                          Operator::release,     Operator::weak_until};
  const std::uint64_t which = random.below(std::size(ops));
  return node(ops[which], random_formula(random, depth - 1),
              which < 4 ? nullptr : random_formula(random, depth - 1));
}

// The definition, read off: what holds at `at` of the endless run, looking ahead as far as matters.
bool holds(const Formula& formula, std::size_t at, std::size_t length, std::size_t loop,
           const std::vector<unsigned>& word) {
  const auto place = [&](std::size_t i) {
    return i < length ? i : loop + (i - loop) % (length - loop);
  };
  const auto sub = [&](const Formula& part, std::size_t i) {
    return holds(part, place(i), length, loop, word);
  };
  // From any position every later one is met within this many steps.
  const std::size_t horizon = at + 2 * length;
  const auto until = [&](auto&& left, auto&& right) {
    for (std::size_t i = at; i < horizon; ++i) {
      if (right(i)) return true;
      if (!left(i)) return false;
    }
    return false;
  };
  const auto always = [&](auto&& part) {
    for (std::size_t i = at; i < horizon; ++i) {
      if (!part(i)) return false;
    }
    return true;
  };
  const auto left = [&](std::size_t i) { return sub(formula->left, i); };
  const auto right = [&](std::size_t i) { return sub(formula->right, i); };
  switch (formula->op) {
    case Operator::truth: return true;
    case Operator::falsity: return false;
    case Operator::atom: return (word[at] >> bit(formula->atom) & 1) != 0;
    case Operator::negation: return !left(at);
    case Operator::next: return left(at + 1);
    case Operator::finally: return until([](std::size_t) { return true; }, left);
    case Operator::globally: return always(left);
    case Operator::conjunction: return left(at) && right(at);
    case Operator::disjunction: return left(at) || right(at);
    case Operator::implication: return !left(at) || right(at);
    case Operator::equivalence: return left(at) == right(at);
    case Operator::until: return until(left, right);
    case Operator::weak_until: return always(left) || until(left, right);
    case Operator::release:
      return always(right) || until(right, [&](std::size_t i) { return left(i) && right(i); });
  }
  return false;
}

TEST_F(FormulaTest, LassoSemanticsIsTheDefinition) {
  Random random(7);
  for (int round = 0; round < 3000; ++round) {
    const Formula formula = random_formula(random, 3);
    const std::size_t length = 1 + random.below(5);
    const std::size_t loop = random.below(length);
    std::vector<unsigned> word;
    for (std::size_t at = 0; at < length; ++at)
      word.push_back(static_cast<unsigned>(random.below(8)));
    const auto value = [&](const Atom& atom, std::size_t at) {
      return (word[at] >> bit(atom) & 1) != 0;
    };
    EXPECT_EQ(holds_on_lasso(formula, length, loop, value), holds(formula, 0, length, loop, word))
        << to_string(formula, scope());
    // The printer and the parser agree.
    EXPECT_EQ(shown(to_string(formula, scope())), to_string(formula, scope()));
  }
}

TEST_F(FormulaTest, CutRunsFailOnBadPrefixesOnly) {
  const auto value = [](const Atom& atom, std::size_t at) { return atom.symbol == 0 && at == 0; };
  const auto holds_when_cut = [&](const std::string& text, std::size_t cut) {
    return holds_on_lasso(parse(text), 3, 2, value, cut);
  };
  EXPECT_TRUE(holds_when_cut("F p@b", 2));
  EXPECT_TRUE(holds_when_cut("G p@a", 1));
  EXPECT_FALSE(holds_when_cut("G p@a", 2));
  EXPECT_FALSE(holds_when_cut("p@a -> p@b", 1));
  EXPECT_TRUE(holds_when_cut("p@a -> (true U p@b)", 1));
  EXPECT_FALSE(holds_when_cut("G (p@a -> F false)", 1));
  EXPECT_TRUE(holds_when_cut("G (p@b -> F false)", 2));
  EXPECT_TRUE(holds_when_cut("G true", 0));
}

TEST_F(FormulaTest, WhereAnAutomatonWaits) {
  const auto waiting = [&](const std::string& text) {
    const std::vector<bool> states = find_waiting(translate(parse(text)));
    return std::count(states.begin(), states.end(), true);
  };
  // Until the response does not come any more.
  EXPECT_EQ(waiting("!G (p@a -> F p@b)"), 1);
  EXPECT_EQ(waiting("F G !p@b"), 1);
  EXPECT_EQ(waiting("G F p@a && F G !p@b"), 1);
  // To come by its mark, it need not leave.
  EXPECT_EQ(waiting("G F p@a"), 0);
  // Which run it is matters.
  EXPECT_EQ(waiting("F (via.write && G !p@b)"), 0);
  EXPECT_EQ(waiting("G !p@b"), 0);
}

}  // namespace
}  // namespace maide
