// SPIN on the exported Promela against the meaning of systems, explored directly: the same verdicts
// and the same number of states, on random systems with fixed seeds and in all three ways of
// meeting the bound.
#include <gtest/gtest.h>

#include <array>

#include "explicit_checker.hpp"
#include "maide/check/spin_engine.hpp"
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
    if (result.verdict == Verdict::holds) {
      EXPECT_EQ(result.states, expected.states()) << show(system);
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

TEST_P(RandomSystems, TemporalPatterns) {
  Random random(static_cast<std::uint64_t>(2000 + GetParam()));
  SpinEngine engine(fast());
  int compared = 0;
  while (compared < 12) {
    const System system = test::random_system(random);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete() || expected.states() < 4) continue;
    ++compared;
    const std::vector<ProgramInterface> interfaces = system.interfaces();
    const FormulaScope scope{system.programs, interfaces};
    const auto parse = [&](const std::string& text) {
      return parse_formula(ScalarText(text, text, {"f", 1, 1}), scope);
    };
    const auto atom = [&] {
      const Program& program = system.programs[random.below(system.programs.size())];
      const std::array<std::string, 4> atoms{
          "m.i0", "m!o0", program.name + "@end",
          program.name + "@" + (program.labels.empty() ? "end" : program.labels[0])};
      return (random.chance(0.3) ? "!" : "") + atoms[random.below(4)];
    };
    const std::string p = atom(), q = "(" + atom() + " || " + atom() + ")";
    const auto label_p = expected.label(parse(p)), label_q = expected.label(parse(q));
    Property property;
    property.fairness = random.chance(0.7) ? Fairness::weak : Fairness::none;
    const bool fair = property.fairness == Fairness::weak;
    bool holds = false;
    switch (random.below(5)) {
      case 0:
        property.name = "G " + q;
        holds = expected.holds_globally(label_q);
        break;
      case 1:
        property.name = p + " U " + q;
        holds = expected.holds_until(label_p, label_q, fair);
        break;
      case 2:
        property.name = "G F " + p;
        holds = expected.holds_infinitely_often(label_p, fair);
        break;
      case 3:
        property.name = "F G " + p;
        holds = expected.holds_from_some_point(label_p, fair);
        break;
      default:
        property.name = "G (" + p + " -> F " + q + ")";
        holds = expected.holds_response(label_p, label_q, fair);
    }
    property.formula = parse(property.name);
    // A violation's trace is replayed and held against the formula inside.
    const PropertyResult result = engine.check(system, property, {});
    ASSERT_NE(result.verdict, Verdict::inconclusive) << result.reason;
    EXPECT_EQ(result.verdict == Verdict::holds, holds)
        << property.name << (fair ? " (weak fairness)" : "") << "\n"
        << write_promela(system, {PromelaOptions::Purpose::ltl, property.formula}).text;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomSystems, testing::Range(0, 10));

}  // namespace
}  // namespace maide
