// Counterexamples of random systems with their steps put into another order: they stay
// counterexamples, and no order of the same steps has fewer switches.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "maide/check/system/trace.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

Property built_in(Property::Kind kind) {
  Property property;
  property.name = kind == Property::Kind::stuck ? "stuck" : "deadlock";
  property.kind = kind;
  return property;
}

// The edges of each program, in the order in which it takes them.
std::map<std::uint32_t, std::vector<std::uint32_t>> own_steps(const Trace& trace) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> own;
  for (const Step& step : trace.steps) own[step.actor].push_back(step.action);
  return own;
}

// The fewest switches of all orders in which the programs keep their own steps and that end in the
// same state: all of them are tried.
class AllOrders {
 public:
  AllOrders(const System& system, const Trace& trace)
      : system_(system),
        own_(own_steps(trace)),
        end_(replay(system, trace).back()),
        fewest_(trace.steps.size()) {
    go_on(initial_state(system), trace.steps.size(), ~std::uint32_t{0}, 0);
  }
  std::size_t fewest() const { return fewest_; }

 private:
  void go_on(const GlobalState& state, std::size_t left, std::uint32_t last, std::size_t switches) {
    if (left == 0) {
      if (state == end_) fewest_ = std::min(fewest_, switches);
      return;
    }
    for (const Step& step : enabled_steps(system_, state)) {
      const auto& own = own_[step.actor];
      std::size_t& done = done_[step.actor];
      if (done == own.size() || own[done] != step.action) continue;
      ++done;
      const bool is_switch = last != ~std::uint32_t{0} && last != step.actor;
      go_on(apply(system_, state, step), left - 1, step.actor, switches + (is_switch ? 1 : 0));
      --done_[step.actor];
    }
  }

  const System& system_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> own_;
  std::map<std::uint32_t, std::size_t> done_;
  GlobalState end_;
  std::size_t fewest_;
};

void expect_as_good(const System& system, const Property& property, const Trace& before,
                    const Trace& after) {
  EXPECT_EQ(after.steps.size(), before.steps.size());
  EXPECT_EQ(after.loop_start, before.loop_start);
  EXPECT_EQ(own_steps(after), own_steps(before));
  EXPECT_LE(count_switches(after), count_switches(before));
  EXPECT_EQ(find_flaw(system, property, after), "");
}

TEST(FewestSwitches, OfDeadlocksAreFewest) {
  Random random(9000);
  NativeEngine engine;
  const Property property = built_in(Property::Kind::deadlock);
  int compared = 0, improved = 0;
  while (compared < 100) {
    const System system = test::random_system(random);
    const PropertyResult result = engine.check(system, property, {});
    if (!result.trace || result.trace->steps.size() > 14) continue;
    if (count_switches(*result.trace) < 2) continue;
    ++compared;
    const Trace best = with_fewest_switches(system, property, *result.trace);
    expect_as_good(system, property, *result.trace, best);
    EXPECT_EQ(count_switches(best), AllOrders(system, *result.trace).fewest());
    improved += count_switches(best) < count_switches(*result.trace) ? 1 : 0;
    // Without the search.
    expect_as_good(system, property, *result.trace,
                   with_fewest_switches(system, property, *result.trace, 0));
  }
  EXPECT_GT(improved, 20);
}

TEST(FewestSwitches, KeepFormulasViolated) {
  Random random(9100);
  NativeEngine engine;
  int compared = 0, improved = 0, loops = 0;
  while (compared < 120) {
    const System system = test::random_system(random);
    const std::vector<ProgramInterface> interfaces = system.interfaces();
    const std::string formulas[] = {
        "G (m.i0 -> F m!o0)",
        "G F m.i0",
        "F " + system.programs[0].name + "@end",
        "G (m.i0 -> X m!o0)",
        "!m!o0 U m.i0",
        "G !(m!o0 && " + system.programs.back().name + "@end)",
    };
    const std::string& text = formulas[random.below(std::size(formulas))];
    Property property = built_in(Property::Kind::stuck);
    if (random.chance(0.8)) {
      property.name = text;
      property.kind = Property::Kind::ltl;
      property.formula =
          parse_formula(ScalarText(text, text, {"f", 1, 1}), {system.programs, interfaces});
      property.fairness = random.chance(0.5) ? Fairness::weak : Fairness::none;
    }
    const PropertyResult result = engine.check(system, property, {});
    if (!result.trace || count_switches(*result.trace) < 2) continue;
    ++compared;
    loops += result.trace->loop_start ? 1 : 0;
    for (const std::size_t most_nodes : {0, 100'000}) {
      const Trace better = with_fewest_switches(system, property, *result.trace, most_nodes);
      expect_as_good(system, property, *result.trace, better);
      improved += count_switches(better) < count_switches(*result.trace) ? 1 : 0;
    }
  }
  EXPECT_GT(improved, 20);
  EXPECT_GT(loops, 10);
}

}  // namespace
}  // namespace maide
