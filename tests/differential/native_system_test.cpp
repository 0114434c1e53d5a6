// The native engine against the meaning of systems, explored directly: verdicts, numbers of states
// and of transitions, and the length of what it shows, which must be shortest.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "explicit_checker.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/packed/packed_system.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

constexpr std::size_t node_limit = 20'000;

Property deadlock() {
  Property property;
  property.name = "deadlock";
  property.kind = Property::Kind::deadlock;
  return property;
}

Formula parse(const std::string& text, const System& system) {
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  return parse_formula(ScalarText(text, text, {"f", 1, 1}), {system.programs, interfaces});
}

std::string show(const System& system) { return write_promela(system).text; }

TEST(PackedSystem, UndoesEveryStepByItsCode) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const System system = test::random_system(random);
    for (const std::size_t monitor_states : {1, 5}) {
      ASSERT_NO_THROW(PackedSystem(system, 0, monitor_states).check_invariants()) << show(system);
    }
  }
}

class NativeOnRandomSystems : public testing::TestWithParam<int> {};

TEST_P(NativeOnRandomSystems, DeadlocksAndCutsAreShortest) {
  Random random(static_cast<std::uint64_t>(5000 + GetParam()));
  NativeEngine engine;
  int deadlocks = 0, cuts = 0;
  for (int compared = 0; compared < 250;) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete()) continue;
    ++compared;
    const PropertyResult result = engine.check(system, deadlock(), {});
    if (expected.shortest_deadlock()) {
      ++deadlocks;
      ASSERT_EQ(result.verdict, Verdict::violated) << show(system);
      EXPECT_EQ(result.trace->steps.size(), *expected.shortest_deadlock()) << show(system);
      EXPECT_EQ(find_flaw(system, deadlock(), *result.trace), "");
    } else {
      ASSERT_EQ(result.verdict, Verdict::holds) << show(system);
      EXPECT_EQ(result.states, expected.states()) << show(system);
    }
    const CutResult cut = engine.find_cut(system, {});
    ASSERT_EQ(cut.verdict == Verdict::violated, expected.shortest_cut().has_value())
        << show(system);
    if (cut.trace) {
      ++cuts;
      EXPECT_EQ(cut.trace->steps.size(), *expected.shortest_cut());
    }
  }
  EXPECT_GE(deadlocks + cuts, 20);
}

TEST_P(NativeOnRandomSystems, Invariants) {
  Random random(static_cast<std::uint64_t>(6000 + GetParam()));
  NativeEngine engine;
  int violations = 0;
  for (int compared = 0; compared < 250;) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete()) continue;
    ++compared;
    const auto atom = [&]() -> std::string {
      const Program& program = system.programs[random.below(system.programs.size())];
      const std::string label = program.labels.empty() ? "end" : program.labels[0];
      const std::string atoms[] = {"m.i0", "m!o0", program.name + "@end",
                                   program.name + "@" + label};
      return (random.chance(0.5) ? "!" : "") + atoms[random.below(4)];
    };
    const std::string condition =
        "(" + atom() + (random.chance(0.5) ? " || " : " -> ") + atom() + ")";
    Property property;
    property.name = "G " + condition;
    property.formula = parse(property.name, system);
    const bool holds = expected.holds_globally(expected.label(parse(condition, system)));
    const PropertyResult result = engine.check(system, property, {});
    ASSERT_EQ(result.verdict == Verdict::holds, holds) << property.name << "\n" << show(system);
    violations += holds ? 0 : 1;
  }
  EXPECT_GT(violations, 10);
}

// A formula of one of the patterns that the explicit checker knows.
struct Pattern {
  std::string text;
  bool holds = false;
};

Pattern random_pattern(const System& system, const test::ExplicitChecker& expected, Random& random,
                       Fairness fair) {
  const auto atom = [&]() -> std::string {
    const Program& program = system.programs[random.below(system.programs.size())];
    const std::string label = program.labels.empty() ? "end" : program.labels[0];
    const std::string atoms[] = {"m.i0", "m!o0", program.name + "@end", program.name + "@" + label};
    return (random.chance(0.4) ? "!" : "") + atoms[random.below(4)];
  };
  const std::string p = atom(), q = "(" + atom() + " || " + atom() + ")";
  const auto in_p = expected.label(parse(p, system)), in_q = expected.label(parse(q, system));
  switch (random.below(4)) {
    case 0: return {p + " U " + q, expected.holds_until(in_p, in_q, fair)};
    case 1: return {"G F " + p, expected.holds_infinitely_often(in_p, fair)};
    case 2: return {"F G " + p, expected.holds_from_some_point(in_p, fair)};
    default: return {"G (" + p + " -> F " + q + ")", expected.holds_response(in_p, in_q, fair)};
  }
}

TEST_P(NativeOnRandomSystems, TemporalPatterns) {
  Random random(static_cast<std::uint64_t>(7000 + GetParam()));
  NativeEngine engine;
  int violations = 0;
  for (int compared = 0; compared < 400;) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, 300);
    if (!expected.is_complete()) continue;
    ++compared;
    const Fairness fairness[] = {Fairness::none, Fairness::weak, Fairness::strong};
    const Fairness fair = fairness[random.below(3)];
    const Pattern pattern = random_pattern(system, expected, random, fair);
    Property property;
    property.name = pattern.text;
    property.formula = parse(pattern.text, system);
    property.fairness = fair;
    const PropertyResult result = engine.check(system, property, {});
    ASSERT_EQ(result.verdict == Verdict::holds, pattern.holds)
        << pattern.text << ", fairness " << static_cast<int>(fair) << "\n"
        << show(system);
    violations += pattern.holds ? 0 : 1;
    // The fairer the runs, the more holds; each violation's trace was held against the formula.
    property.fairness = Fairness::strong;
    const PropertyResult strong = engine.check(system, property, {});
    if (pattern.holds) {
      EXPECT_EQ(strong.verdict, Verdict::holds) << pattern.text << show(system);
    }
  }
  EXPECT_GT(violations, 10);
}

TEST_P(NativeOnRandomSystems, StuckPrograms) {
  Random random(static_cast<std::uint64_t>(8000 + GetParam()));
  NativeEngine engine;
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  int violations = 0;
  for (int compared = 0; compared < 60 || (violations < 4 && compared < 5000);) {
    const System system = test::random_system(random);
    const test::ExplicitChecker size(system, 60);
    if (!size.is_complete()) continue;
    ++compared;
    const PropertyResult result = engine.check(system, property, {});
    const bool expected = test::has_stuck_program(system);
    ASSERT_EQ(result.verdict == Verdict::violated, expected) << show(system);
    violations += expected ? 1 : 0;
  }
  EXPECT_GT(violations, 3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, NativeOnRandomSystems, testing::Range(0, 4));
INSTANTIATE_TEST_SUITE_P(Many, NativeOnRandomSystems, testing::Range(4, 8));

}  // namespace
}  // namespace maide
