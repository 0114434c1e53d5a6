// How long the runs are on which a program is stuck, against the meaning of systems, explored
// directly.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "explicit_checker.hpp"
#include "joint_systems.hpp"
#include "maide/check/engines/engine.hpp"

namespace maide {
namespace {

Property stuck() {
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  return property;
}

// Steps of the run before a program that never steps again cannot step any more.
std::size_t steps_before(const System& system, const Trace& trace) {
  const std::vector<GlobalState> states = replay(system, trace);
  std::size_t least = states.size();
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState last = states.back().programs[index];
    if (program.is_end(last) || program.may_rest(last) || !program.flags.is_fair) continue;
    const auto can_step = [&](std::size_t at) {
      const auto steps = enabled_steps(system, states[at], index);
      return std::ranges::any_of(steps,
                                 [&](const auto& step) { return is_progress(system, step); });
    };
    bool is_stuck = true;
    for (std::size_t at = *trace.loop_start; at < states.size(); ++at) {
      is_stuck = is_stuck && !can_step(at);
    }
    if (!is_stuck) continue;
    std::size_t from = *trace.loop_start;
    while (from > 0 && !can_step(from - 1)) --from;
    least = std::min(least, from);
  }
  return least;
}

class ShortRuns : public testing::TestWithParam<int> {};

TEST_P(ShortRuns, ComeSoonToWhereAProgramIsStuck) {
  Random random(static_cast<std::uint64_t>(7100 + GetParam()));
  NativeEngine engine;
  int violated = 0, open = 0, far = 0;
  for (int compared = 0; compared < 400 && !HasFailure(); ++compared) {
    const System system = test::random_joint_system(
        random, {2, 3, 3, 0.7, 0.9}, {.groups = compared % 2 == 0, .nobody = compared % 3 == 0});
    if (!test::ExplicitChecker(system, 300).is_complete()) continue;
    const std::optional<std::size_t> nearest = test::nearest_stuck(system);
    EngineOptions options;
    options.threads = 1;
    const PropertyResult result = engine.check(system, stuck(), options);
    ASSERT_EQ(result.verdict == Verdict::violated, nearest.has_value()) << test::show(system);
    if (!nearest) continue;
    ++violated;
    far += *nearest > 3 ? 1 : 0;
    const std::size_t steps = steps_before(system, *result.trace);
    EXPECT_GE(steps, *nearest) << test::show(system);
    EXPECT_LE(2 * steps, 3 * *nearest) << test::show(system);
    const std::vector<GlobalState> states = replay(system, *result.trace);
    open += models_that_fill(*result.trace, states).empty() ? 0 : 1;
    options.threads = 3;
    options.states_a_thread = 1;
    EXPECT_EQ(engine.check(system, stuck(), options).trace, result.trace) << test::show(system);
  }
  EXPECT_GT(violated, 20);
  RecordProperty("violated", violated);
  RecordProperty("open", open);
  EXPECT_GT(far, 1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ShortRuns, testing::Range(0, 3));

}  // namespace
}  // namespace maide
