// SPIN on the exported Promela against the meaning of systems, explored directly: the same verdicts
// and the same number of states, on random systems with fixed seeds and in all three ways of
// meeting the bound.
#include <gtest/gtest.h>

#include <array>

#include "explicit_checker.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

constexpr std::size_t node_limit = 1500;

SpinOptions fast() {
  SpinOptions options;
  options.optimisation = "-O0";
  options.shortens = false;
  return options;
}

std::string show(const System& system) { return write_promela(system).text; }

class RandomSystems : public testing::TestWithParam<int> {};

TEST_P(RandomSystems, DeadlocksCutsAndStates) {
  Random random(static_cast<std::uint64_t>(1000 + GetParam()));
  SpinEngine engine(fast());
  int compared = 0, deadlocks = 0;
  while (compared < 12) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete() || expected.states() < 4) continue;
    ++compared;
    Property deadlock;
    deadlock.name = "deadlock";
    deadlock.kind = Property::Kind::deadlock;
    const PropertyResult result = engine.check(system, deadlock, {});
    ASSERT_NE(result.verdict, Verdict::inconclusive) << result.reason;
    EXPECT_EQ(result.verdict == Verdict::violated, expected.shortest_deadlock().has_value())
        << show(system);
    const PropertyResult native = NativeEngine().check(system, deadlock, {});
    EXPECT_EQ(native.verdict, result.verdict) << show(system);
    if (result.verdict == Verdict::holds) {
      EXPECT_EQ(result.states, expected.states()) << show(system);
      EXPECT_EQ(result.states, native.states) << show(system);
    } else {
      ++deadlocks;
      EXPECT_GE(result.trace->steps.size(), *expected.shortest_deadlock());
      EXPECT_EQ(find_flaw(system, deadlock, *result.trace), "");
    }
    const CutResult cut = engine.find_cut(system, {});
    EXPECT_EQ(cut.verdict == Verdict::violated, expected.shortest_cut().has_value())
        << show(system);
  }
  EXPECT_GT(deadlocks, 0);
}

// Where the time suffices - these searches take milliseconds - shortened runs are shortest.
TEST_P(RandomSystems, ShortestDeadlocks) {
  Random random(static_cast<std::uint64_t>(3000 + GetParam()));
  SpinOptions options = fast();
  options.shortens = true;
  SpinEngine engine(options);
  for (int compared = 0; compared < 3;) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete() || expected.shortest_deadlock().value_or(0) < 4) continue;
    ++compared;
    Property deadlock;
    deadlock.kind = Property::Kind::deadlock;
    const PropertyResult result = engine.check(system, deadlock, {});
    ASSERT_TRUE(result.trace);
    EXPECT_EQ(result.trace->steps.size(), *expected.shortest_deadlock()) << show(system);
  }
}

// A formula of one of the patterns that the explicit checker knows.
struct Pattern {
  enum class Kind : std::uint8_t { globally, until, infinitely_often, from_some_point, response };
  Kind kind = Kind::globally;
  std::string p, q;  // boolean expressions

  std::string text() const {
    switch (kind) {
      case Kind::globally: return "G " + q;
      case Kind::until: return p + " U " + q;
      case Kind::infinitely_often: return "G F " + p;
      case Kind::from_some_point: return "F G " + p;
      case Kind::response: return "G (" + p + " -> F " + q + ")";
    }
    return "";
  }
};

Formula parse(const std::string& text, const System& system) {
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  return parse_formula(ScalarText(text, text, {"f", 1, 1}), {system.programs, interfaces});
}

Pattern random_pattern(const System& system, Random& random) {
  const auto atom = [&] {
    const Program& program = system.programs[random.below(system.programs.size())];
    const std::array<std::string, 4> atoms{
        "m.i0", "m!o0", program.name + "@end",
        program.name + "@" + (program.labels.empty() ? "end" : program.labels[0])};
    return (random.chance(0.4) ? "!" : "") + atoms[random.below(4)];
  };
  const std::string p = atom();
  return {static_cast<Pattern::Kind>(random.below(5)), p, "(" + atom() + " || " + atom() + ")"};
}

bool holds(const test::ExplicitChecker& checker, const Pattern& pattern, const System& system,
           Fairness fairness) {
  const auto p = checker.label(parse(pattern.p, system));
  const auto q = checker.label(parse(pattern.q, system));
  switch (pattern.kind) {
    case Pattern::Kind::globally: return checker.holds_globally(q);
    case Pattern::Kind::until: return checker.holds_until(p, q, fairness);
    case Pattern::Kind::infinitely_often: return checker.holds_infinitely_often(p, fairness);
    case Pattern::Kind::from_some_point: return checker.holds_from_some_point(p, fairness);
    case Pattern::Kind::response: return checker.holds_response(p, q, fairness);
  }
  return false;
}

void compare(const System& system, const Pattern& pattern, bool fair, bool expected) {
  Property property;
  property.name = pattern.text();
  property.fairness = fair ? Fairness::weak : Fairness::none;
  property.formula = parse(property.name, system);
  // A violation's trace is replayed and held against the formula inside.
  SpinEngine engine(fast());
  const PropertyResult result = engine.check(system, property, {});
  ASSERT_NE(result.verdict, Verdict::inconclusive) << result.reason;
  EXPECT_EQ(NativeEngine().check(system, property, {}).verdict, result.verdict) << property.name;
  EXPECT_EQ(result.verdict == Verdict::holds, expected)
      << property.name << (fair ? " (weak fairness)" : "") << "\n"
      << write_promela(system, {PromelaOptions::Purpose::ltl, property.formula}).text;
}

// Counts one down, if any are left.
bool take(int& left) {
  if (left == 0) return false;
  --left;
  return true;
}

// Of each batch some are any formulas, some depend on fairness, some on the last event of a run
// that ends, and some on runs that are cut.
TEST_P(RandomSystems, TemporalPatterns) {
  Random random(static_cast<std::uint64_t>(2000 + GetParam()));
  int any = 3, on_fairness = 3, on_last_event = 3, on_cut = 2;
  while (any + on_fairness + on_last_event + on_cut > 0) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete() || expected.states() < 4) continue;
    const Pattern pattern = random_pattern(system, random);
    const bool fair = holds(expected, pattern, system, Fairness::weak);
    const bool unfair = holds(expected, pattern, system, Fairness::none);
    if (fair != unfair && take(on_fairness)) {
      compare(system, pattern, true, fair);
      compare(system, pattern, false, unfair);
      continue;
    }
    using Checker = test::ExplicitChecker;
    const Checker keeping(system, node_limit, Checker::LastEvent::kept);
    if (holds(keeping, pattern, system, Fairness::weak) != fair && take(on_last_event)) {
      compare(system, pattern, true, fair);
    } else if (fair && expected.shortest_cut() && take(on_cut)) {
      compare(system, pattern, true, fair);
    } else if (fair == unfair && take(any)) {
      compare(system, pattern, random.chance(0.5), fair);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomSystems, testing::Range(0, 1));
INSTANTIATE_TEST_SUITE_P(Many, RandomSystems, testing::Range(1, 6));

}  // namespace
}  // namespace maide
