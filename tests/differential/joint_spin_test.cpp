// Systems with joint steps against SPIN, on random systems with fixed seeds: the exported Promela
// has as many states and transitions as the engine visits, and the same deadlocks, errors, runs
// beyond what was learned, and verdicts on formulas over events, labels and variables.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "joint_systems.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/spin_engine.hpp"

namespace maide {
namespace {

constexpr std::uint64_t most_states = 20'000;
constexpr int most_temporal_operators = 4;  // `spin -f` may take for ever with more

SpinOptions fast() {
  SpinOptions options;
  options.optimisation = "-O0";
  options.shortens = false;
  return options;
}

Property built_in(Property::Kind kind) {
  Property property;
  property.name = kind == Property::Kind::deadlock ? "deadlock" : "error";
  property.kind = kind;
  return property;
}

Expression operation(Expression::Operator op, Expression left, Expression right) {
  Expression expression;
  expression.op = op;
  expression.kind = ValueKind::boolean;
  expression.operands = {std::move(left), std::move(right)};
  return expression;
}

// Random formulas without X, over all kinds of atoms.
class FormulaMaker {
 public:
  FormulaMaker(System& system, Random& random) : system_(system), random_(random) {}

  Formula make(int depth) {
    using Operator = FormulaNode::Operator;
    if (depth == 0 || random_.chance(0.1)) return make_atom();
    constexpr std::array unary{Operator::negation, Operator::finally, Operator::globally};
    constexpr std::array binary{Operator::conjunction, Operator::disjunction, Operator::implication,
                                Operator::until,       Operator::release,     Operator::weak_until};
    FormulaNode node;
    if (random_.chance(0.5)) {
      node.op = pick(unary);
      node.left = make(depth - 1);
    } else {
      node.op = pick(binary);
      node.left = make(depth - 1);
      node.right = make(depth - 1);
    }
    const bool is_temporal = node.op == Operator::finally || node.op == Operator::globally ||
                             node.op == Operator::until || node.op == Operator::release ||
                             node.op == Operator::weak_until;
    temporal_operators_ += is_temporal ? 1 : 0;
    return std::make_shared<const FormulaNode>(std::move(node));
  }
  int temporal_operators() const { return temporal_operators_; }

 private:
  template <typename Values>
  typename Values::value_type pick(const Values& values) {
    return values[random_.below(values.size())];
  }
  std::uint32_t below(std::size_t count) {
    return static_cast<std::uint32_t>(random_.below(count));
  }

  Formula make_atom() {
    FormulaNode node;
    node.op = FormulaNode::Operator::atom;
    Atom& atom = node.atom;
    const std::uint32_t program = below(system_.programs.size());
    const std::uint32_t model = below(system_.models.size() - 1);  // but for the variable
    switch (random_.below(5)) {
      case 0:
        if (!system_.programs[program].labels.empty()) {
          atom = {Atom::Kind::label, program, below(system_.programs[program].labels.size()),
                  Atom::any_program};
          break;
        }
        [[fallthrough]];
      case 1: atom = {Atom::Kind::end, program, 0, Atom::any_program}; break;
      case 2:
        atom = {Atom::Kind::input, model, below(system_.models[model].automaton.inputs().size()),
                random_.chance(0.5) ? program : Atom::any_program};
        break;
      case 3:
        atom = {Atom::Kind::output, model, below(system_.models[model].automaton.outputs().size()),
                random_.chance(0.5) ? program : Atom::any_program};
        break;
      default:
        using Operator = Expression::Operator;
        constexpr std::array comparisons{Operator::equal, Operator::unequal, Operator::less};
        system_.expressions.push_back(operation(pick(comparisons), make_term(), make_term()));
        atom = {Atom::Kind::expression, static_cast<std::uint32_t>(system_.expressions.size() - 1),
                0, Atom::any_program};
    }
    return std::make_shared<const FormulaNode>(std::move(node));
  }

  Expression make_term() {
    Expression term;
    switch (random_.below(3)) {
      case 0: term.value = static_cast<Value>(random_.below(3)); break;
      case 1:
        term.op = Expression::Operator::shared;
        term.index = static_cast<std::uint32_t>(system_.models.size() - 1);
        break;
      default: term.op = Expression::Operator::local; term.owner = below(system_.programs.size());
    }
    return term;
  }

  System& system_;
  Random& random_;
  int temporal_operators_ = 0;
};

// A variable of 0..2 in each program, out of scope in some of its states.
void add_variables(System& system, Random& random) {
  for (Program& program : system.programs) {
    program.variables.push_back({"x", {ValueKind::integer, 0, 2, {}}, {}});
    program.valuations = {{std::nullopt}, {0}, {1}, {2}};
    for (Program::State& state : program.states) {
      state.valuation = static_cast<std::uint32_t>(random.below(4));
    }
  }
}

class JointSystemsAgree : public testing::TestWithParam<int> {
 protected:
  // The next random system that is worth it, and not too large; with its deadlock by the engine.
  System next() {
    while (true) {
      const test::JointSystemKinds kinds{random_.chance(0.4), random_.chance(0.3),
                                         random_.chance(0.5), false, random_.chance(0.4)};
      System system = test::random_joint_system(random_, {1, 3, 2, 0.5, 0.7}, kinds);
      deadlock_ = native_.check(system, built_in(Property::Kind::deadlock), {});
      if (deadlock_.states >= 6 && deadlock_.states <= most_states) return system;
    }
  }

  Random random_{static_cast<std::uint64_t>(7100 + GetParam())};
  NativeEngine native_;
  SpinEngine spin_{fast()};
  PropertyResult deadlock_;
};

TEST_P(JointSystemsAgree, OnDeadlocksErrorsAndStates) {
  int counted = 0, deadlocks = 0, errors = 0, cuts = 0;
  for (int compared = 0; compared < 10 && !HasFailure();) {
    const System system = next();
    const bool is_wanted = deadlock_.verdict == Verdict::holds ? counted < 6 : deadlocks < 4;
    if (!is_wanted) continue;
    ++compared;
    SCOPED_TRACE(write_promela(system).text);
    const PropertyResult theirs = spin_.check(system, built_in(Property::Kind::deadlock), {});
    ASSERT_EQ(theirs.verdict, deadlock_.verdict) << theirs.reason;
    ++(deadlock_.verdict == Verdict::holds ? counted : deadlocks);
    if (deadlock_.verdict == Verdict::holds) {
      EXPECT_EQ(theirs.states, deadlock_.states);
    }
    const PropertyResult ours = native_.check(system, built_in(Property::Kind::error), {});
    if (ours.verdict == Verdict::violated || random_.chance(0.3)) {
      const PropertyResult error = spin_.check(system, built_in(Property::Kind::error), {});
      ASSERT_EQ(error.verdict, ours.verdict) << error.reason;
      errors += ours.verdict == Verdict::violated ? 1 : 0;
      if (ours.verdict == Verdict::holds) {
        EXPECT_EQ(error.states, ours.states);
        EXPECT_EQ(error.transitions, ours.transitions);
      }
    }
    const CutResult cut = native_.find_cut(system, {});
    if (cut.verdict == Verdict::violated || random_.chance(0.2)) {
      EXPECT_EQ(spin_.find_cut(system, {}).verdict, cut.verdict);
      cuts += cut.verdict == Verdict::violated ? 1 : 0;
    }
  }
  EXPECT_GT(counted, 0);
  EXPECT_GT(deadlocks, 0);
  EXPECT_GT(errors + cuts, 0);
}

// A violation's trace is replayed and held against the formula inside.
TEST_P(JointSystemsAgree, OnFormulas) {
  int holds = 0, violated = 0;
  for (int compared = 0; compared < 12 && !HasFailure();) {
    System system = next();
    add_variables(system, random_);
    FormulaMaker maker(system, random_);
    Property property;
    property.name = "formula";
    property.formula = maker.make(3);
    property.fairness = random_.chance(0.6) ? Fairness::weak : Fairness::none;
    if (!spin_.obstacle(system, property).empty()) property.fairness = Fairness::none;
    if (maker.temporal_operators() > most_temporal_operators) continue;
    const PropertyResult ours = native_.check(system, property, {});
    // Most random formulas are violated.
    if (ours.verdict != Verdict::holds && violated == 6) continue;
    ++compared;
    ++(ours.verdict == Verdict::holds ? holds : violated);
    const PropertyResult theirs = spin_.check(system, property, {});
    ASSERT_EQ(theirs.verdict, ours.verdict)
        << theirs.reason << "\nfairness " << static_cast<int>(property.fairness) << "\n"
        << write_promela(system, {PromelaOptions::Purpose::ltl, property.formula}).text;
  }
  EXPECT_GT(holds, 0);
  EXPECT_GT(violated, 0);
}

INSTANTIATE_TEST_SUITE_P(Sample, JointSystemsAgree, testing::Range(0, 1));
INSTANTIATE_TEST_SUITE_P(Many, JointSystemsAgree, testing::Range(1, 100));

}  // namespace
}  // namespace maide
