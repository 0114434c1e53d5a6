// How long the runs are on which a program is stuck, against the meaning of systems, explored
// directly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "explicit_checker.hpp"
#include "joint_systems.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/search/fair_cycle.hpp"
#include "maide/check/search/monitors.hpp"

namespace maide {
namespace {

Property stuck() {
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  return property;
}

// Steps of the run before a program that never steps again cannot step any more. A loop that is
// told in part comes to other states the next time round, so the whole run counts.
std::size_t steps_before(const System& system, const Trace& told) {
  const std::vector<GlobalState> states_told = replay(system, told);
  const bool is_whole = models_that_change(told, states_told).empty();
  const Trace trace = is_whole ? told : closed(system, told, states_told).value();
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

// Whether the loop closes after several rounds. The whole run is a counterexample, too.
bool is_told_in_part(const System& system, const Property& property, const Trace& trace) {
  const std::vector<GlobalState> states = replay(system, trace);
  if (models_that_change(trace, states).empty()) return false;
  const Trace whole = closed(system, trace, states).value();
  EXPECT_EQ(find_flaw(system, property, whole), "") << test::show(system);
  EXPECT_TRUE(models_that_change(whole, replay(system, whole)).empty());
  return true;
}

// "The shared variable is not 0 again and again", or from some point on.
std::vector<Property> formulas_of(System& system) {
  Expression variable;
  variable.op = Expression::Operator::shared;
  variable.kind = ValueKind::boolean;
  variable.index = static_cast<std::uint32_t>(system.models.size() - 1);
  variable.name = "v";
  system.expressions.push_back(variable);
  using Operator = FormulaNode::Operator;
  const Formula set = make_formula(Atom{Atom::Kind::expression, 0, 0, Atom::any_program});
  std::vector<Property> properties;
  for (const auto& [outer, inner] : {std::pair(Operator::globally, Operator::finally),
                                     std::pair(Operator::finally, Operator::globally)}) {
    for (const Fairness fairness : {Fairness::none, Fairness::weak, Fairness::strong}) {
      Property property;
      property.name = "formula";
      property.formula = make_formula(outer, make_formula(inner, set));
      property.fairness = fairness;
      properties.push_back(property);
    }
  }
  return properties;
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
    // A run that is shorter as a whole may come there a step later.
    EXPECT_LE(2 * steps, 3 * *nearest + 2) << test::show(system);
    open += is_told_in_part(system, stuck(), *result.trace) ? 1 : 0;
    options.threads = 3;
    options.states_a_thread = 1;
    EXPECT_EQ(engine.check(system, stuck(), options).trace, result.trace) << test::show(system);
  }
  EXPECT_GT(violated, 20);
  EXPECT_GT(far, 1);
  std::cout << violated << " are violated, " << open << " of them told in part\n";
}

TEST_P(ShortRuns, OfFormulasAreCounterexamplesWhole) {
  Random random(static_cast<std::uint64_t>(7200 + GetParam()));
  int violated = 0, open = 0;
  for (int compared = 0; compared < 200 && !HasFailure(); ++compared) {
    System system =
        test::random_joint_system(random, {2, 3, 3, 0.9, 1, 0.5}, {.groups = compared % 2 == 0});
    const std::vector<Property> properties = formulas_of(system);
    if (!test::ExplicitChecker(system, 300).is_complete()) continue;
    for (const Property& property : properties) {
      const PropertyResult result = NativeEngine().check(system, property, {});
      if (!result.trace) continue;
      ++violated;
      EXPECT_EQ(find_flaw(system, property, *result.trace), "") << test::show(system);
      open += is_told_in_part(system, property, *result.trace) ? 1 : 0;
    }
  }
  EXPECT_GT(violated, 100);
  std::cout << violated << " are violated, " << open << " of them told in part\n";
}

INSTANTIATE_TEST_SUITE_P(Seeds, ShortRuns, testing::Range(0, 3));

// Steps of a run that comes to where some program is stuck as early as any; `nodes` are enough.
std::optional<std::size_t> nearest_by_search(const System& system, std::uint64_t nodes) {
  const PackedSystem packed(system, node_number_bits, system.programs.size() + 1);
  const StuckMonitor<> monitor(packed, StuckRuns::strongly_fair);
  const SearchLimits limits;
  return with_own_words(packed.words(), [&](auto words) -> std::optional<std::size_t> {
    FairCycleSearch<words.value, StuckMonitor<>> search(packed, monitor, limits, nullptr, nodes);
    if (!search.run_nearest().trace) return std::nullopt;
    return search.way().steps.size();
  });
}

// Writes a line: states that the search took, steps to where a program is stuck and in all, both
// without and with a look for a shorter run, the steps to the nearest such state, and the seconds
// of both.
void measure(const std::string& name, const System& system, std::uint64_t nodes) {
  EngineOptions plain, short_one;
  plain.threads = short_one.threads = 1;
  plain.shortens = false;
  const PropertyResult first = NativeEngine().check(system, stuck(), plain);
  if (first.verdict != Verdict::violated) return;
  const PropertyResult result = NativeEngine().check(system, stuck(), short_one);
  ASSERT_EQ(result.verdict, Verdict::violated) << name;
  EXPECT_EQ(result.states, first.states) << name;
  EXPECT_LE(result.trace->steps.size(), first.trace->steps.size()) << name;
  const std::size_t steps = steps_before(system, *result.trace);
  const std::optional<std::size_t> nearest = nearest_by_search(system, nodes);
  std::cout << name << ": " << first.states << " states, " << steps_before(system, *first.trace)
            << " of " << first.trace->steps.size() << " steps, then " << steps << " of "
            << result.trace->steps.size() << ", nearest "
            << (nearest ? std::to_string(*nearest) : "?") << ", " << first.seconds << " s, then "
            << result.seconds << " s" << std::endl;
  EXPECT_LE(2 * steps, 3 * nearest.value_or(steps)) << name;
}

TEST(ShortRunsOf, Architectures) {
  for (const char* name : {"cancel", "heartbeats", "map-server", "multiplexer", "ticks",
                           "ticks-mended", "token", "two-by-two"}) {
    const std::filesystem::path file = std::string(name) + ".yaml";
    measure(name, read_system(MAIDE_SOURCE_DIR "/examples/architectures" / file), 1'000'000);
  }
}

// Workers that count, and now and then hold the mutex that all need; and in their midst some who
// may wait for ever: two who lock two mutexes each in another order, one whose message is
// overwritten, or one whom another may forget to wake.
std::string crowd(Random& random) {
  std::string text =
      "models: {m: {use: mutex}, f: {use: mutex}, g: {use: mutex}, q: {use: queue, with: {depth: " +
      std::to_string(1 + random.below(3)) + "}}}\nprograms:\n";
  const auto count = [&](std::uint64_t least, std::uint64_t most) {
    return "repeat " + std::to_string(least + random.below(most - least + 1)) + " { if * { } } ";
  };
  const auto turn = [&] { return random.below(2) == 0 ? std::string("m.lock; m.unlock; ") : ""; };
  const auto add = [&](const std::string& name, const std::string& code) {
    text += "  " + name + ": \"" + code + "\"\n";
  };
  for (std::uint64_t i = 0, workers = 2 + random.below(2); i < workers; ++i) {
    add("w" + std::to_string(i),
        "loop { " + count(4, 24) + "m.lock; " + count(1, 4) + "m.unlock; }");
  }
  switch (random.below(3)) {
    case 0:
      add("a",
          "loop { " + count(1, 9) + turn() + "f.lock; " + turn() + "g.lock; g.unlock; f.unlock; }");
      add("b",
          "loop { " + count(1, 9) + turn() + "g.lock; " + turn() + "f.lock; f.unlock; g.unlock; }");
      break;
    case 1:
      add("a", count(1, 9) + turn() + "repeat 5 { q.write; " + turn() + "}");
      add("b", turn() + count(1, 9) + "repeat 5 { q.read -> message; " + turn() + "}");
      break;
    default:
      add("a", "loop { " + count(1, 9) + turn() + "if * { q.write; } f.lock; f.unlock; }");
      add("b", "loop { f.lock; " + count(1, 3) + "f.unlock; q.read -> message; " + turn() + "}");
      break;
  }
  return text;
}

class LargeShortRuns : public testing::TestWithParam<int> {};

TEST_P(LargeShortRuns, ComeSoonToWhereAProgramIsStuck) {
  Random random(static_cast<std::uint64_t>(7300 + GetParam()));
  const std::string text = crowd(random);
  const System system = parse_system(text, "crowd.yaml", read_requested_model);
  Property error;
  error.kind = Property::Kind::error;
  const PropertyResult all = NativeEngine().check(system, error, {});
  measure(std::to_string(GetParam()) + " (" + std::to_string(all.states) + ")", system,
          100'000'000);
}

INSTANTIATE_TEST_SUITE_P(Many, LargeShortRuns, testing::Range(0, 120));

}  // namespace
}  // namespace maide
