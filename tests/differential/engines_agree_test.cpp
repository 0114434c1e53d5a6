// The two engines against each other on 2,000 random systems with fixed seeds: equal verdicts on
// deadlocks and on formulas of any shape, with and without weak fairness, and equal numbers of
// states where everything is explored. A sample of them is part of every run of the tests. And on
// the systems of bench_check, in small.
#include <gtest/gtest.h>

#include <string>

#include "check_systems.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/experiment/open_system.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

constexpr int systems_a_batch = 40;
constexpr int most_deadlocks = 30;  // among these
constexpr std::uint64_t most_states = 50'000;

SpinOptions fast() {
  SpinOptions options;
  options.optimisation = "-O0";
  options.shortens = false;
  if (find_on_path("clang")) options.compiler = "clang";  // compiles pan in half the time
  return options;
}

std::string random_atom(const System& system, Random& random) {
  const Program& program = system.programs[random.below(system.programs.size())];
  const ModelInstance& model = system.models[random.below(system.models.size())];
  const auto any_of = [&](const auto& names) -> std::string {
    return names[random.below(names.size())];
  };
  switch (random.below(4)) {
    case 0: return model.name + "." + any_of(model.automaton.inputs().names());
    case 1: return model.name + "!" + any_of(model.automaton.outputs().names());
    case 2:
      if (!program.labels.empty()) return program.name + "@" + any_of(program.labels);
      [[fallthrough]];
    default: return program.name + "@end";
  }
}

// `spin -f` may take for ever with more.
constexpr int most_temporal_operators = 5;

int count_temporal_operators(const Formula& formula) {
  if (!formula) return 0;
  const bool is_temporal = formula->op == FormulaNode::Operator::finally ||
                           formula->op == FormulaNode::Operator::globally ||
                           formula->op == FormulaNode::Operator::until ||
                           formula->op == FormulaNode::Operator::release ||
                           formula->op == FormulaNode::Operator::weak_until;
  return (is_temporal ? 1 : 0) + count_temporal_operators(formula->left) +
         count_temporal_operators(formula->right);
}

// Without X, which SPIN has not.
std::string random_formula(const System& system, Random& random, int depth) {
  if (depth == 0 || random.chance(0.1)) return random_atom(system, random);
  const std::string left = random_formula(system, random, depth - 1);
  static const std::vector<std::string> unary{"!", "F", "G", "G F", "F G"};
  static const std::vector<std::string> binary{"&&", "||", "->", "U", "R", "W"};
  if (random.chance(0.5)) return unary[random.below(unary.size())] + " (" + left + ")";
  return "(" + left + ") " + binary[random.below(binary.size())] + " (" +
         random_formula(system, random, depth - 1) + ")";
}

Property random_property(const System& system, Random& random) {
  Property property;
  const std::string text = random_formula(system, random, 3);
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  property.name = text;
  property.formula =
      parse_formula(ScalarText(text, text, {"f", 1, 1}), {system.programs, interfaces});
  property.fairness = random.chance(0.5) ? Fairness::weak : Fairness::none;
  return property;
}

class RandomSystemsAgree : public testing::TestWithParam<int> {};

TEST_P(RandomSystemsAgree, OnVerdictsAndStates) {
  Random random(static_cast<std::uint64_t>(90'000 + GetParam()));
  NativeEngine native;
  SpinEngine spin(fast());
  Property deadlock;
  deadlock.name = "deadlock";
  deadlock.kind = Property::Kind::deadlock;
  int counted = 0, deadlocks = 0;
  for (int compared = 0; compared < systems_a_batch;) {
    const System system = test::random_system(random);
    const PropertyResult ours = native.check(system, deadlock, {});
    if (ours.states < 4 || ours.states > most_states) continue;
    // Most random systems deadlock; of those that do not the states can be counted.
    if (ours.verdict != Verdict::holds && deadlocks == most_deadlocks) continue;
    ++compared;
    const auto show = [&] { return write_promela(system).text; };
    const PropertyResult theirs = spin.check(system, deadlock, {});
    ASSERT_EQ(ours.verdict, theirs.verdict) << show();
    if (ours.verdict == Verdict::holds) {
      ++counted;
      ASSERT_EQ(ours.states, theirs.states) << show();  // the engine has taken its extra one off
    } else {
      ++deadlocks;
    }
    if (!random.chance(0.4)) continue;
    const Property property = random_property(system, random);
    if (count_temporal_operators(property.formula) > most_temporal_operators) continue;
    ASSERT_EQ(native.check(system, property, {}).verdict, spin.check(system, property, {}).verdict)
        << property.name << (property.fairness == Fairness::weak ? " (weak fairness)\n" : "\n")
        << show();
  }
  EXPECT_GE(counted, systems_a_batch - most_deadlocks);
  EXPECT_GT(deadlocks, 0);
}

TEST(BenchmarkSystems, EnginesAgree) {
  const TempDir folder;
  NativeEngine native;
  SpinEngine spin(fast());
  for (const bench::SystemText& text : {bench::grasping(10), bench::philosophers(5),
                                        bench::pipeline(3, 2), bench::token_ring(3, 1)}) {
    const System system = read_system(bench::write_system(text, folder.path()));
    for (const std::string name : {"deadlock", "response"}) {
      const Property property = find_property(system, name);
      const PropertyResult ours = native.check(system, property, {});
      const PropertyResult theirs = spin.check(system, property, {});
      EXPECT_EQ(ours.verdict, Verdict::holds) << text.name << ": " << name;
      EXPECT_EQ(theirs.verdict, Verdict::holds) << text.name << ": " << name;
      if (name == "deadlock") {
        EXPECT_EQ(ours.states, theirs.states) << text.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sample, RandomSystemsAgree, testing::Range(0, 1));
INSTANTIATE_TEST_SUITE_P(TwoThousand, RandomSystemsAgree, testing::Range(1, 50));

}  // namespace
}  // namespace maide
