// Systems with joint steps: what the engine makes of them against their meaning, explored directly.
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "explicit_checker.hpp"
#include "joint_systems.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/packed/packed_system.hpp"
#include "mailbox_ranks.hpp"

namespace maide {
namespace {

constexpr std::size_t node_limit = 3000;
constexpr test::JointSystemKinds everything{true, true, true, true, false};
constexpr test::JointSystemKinds with_nobody{.nobody = true};
constexpr test::JointSystemKinds everything_with_nobody{true, true, true, true, true};

Property built_in(Property::Kind kind) {
  Property property;
  property.name = kind == Property::Kind::deadlock ? "deadlock" : "other";
  property.kind = kind;
  return property;
}

EngineOptions with(Reduction reduction) {
  EngineOptions options;
  options.reduction = reduction;
  return options;
}

// The state and every step that the tables have there, as the meaning has them.
template <std::size_t words>
void compare_steps(const PackedSystem& packed, const GlobalState& state) {
  const System& system = packed.system();
  const auto here = packed.pack<words>(state);
  ASSERT_EQ(packed.unpack(here), state);
  const std::vector<Step> expected = enabled_steps(system, state);
  std::size_t at = 0;
  if (is_error(system, state)) return;
  for (std::size_t actor = 0; actor < packed.actor_count(); ++actor) {
    packed.for_each_step(
        here, actor,
        [&](const PackedState<words>& next, std::uint32_t action, bool is_cut, std::uint64_t code) {
          ASSERT_LT(at, expected.size());
          const Step& step = expected[at++];
          EXPECT_EQ(step.actor, actor < packed.program_count() ? actor : nobody);
          EXPECT_EQ(step.action, action);
          EXPECT_EQ(step.is_cut, is_cut);
          GlobalState after = apply(system, state, step);
          after.is_cut = false;
          ASSERT_EQ(packed.unpack(next), after);
          const StepBefore origin = packed.undo(after, code);
          EXPECT_EQ(origin.step, step);
          EXPECT_EQ(origin.before, state);
        });
  }
  EXPECT_EQ(at, expected.size());
}

std::vector<GlobalState> reachable_states(const System& system, std::size_t limit) {
  std::vector<GlobalState> states{initial_state(system)};
  std::map<std::vector<std::uint32_t>, bool> known;
  const auto is_new = [&](const GlobalState& state) {
    std::vector<std::uint32_t> key(state.models.begin(), state.models.end());
    key.insert(key.end(), state.programs.begin(), state.programs.end());
    return known.try_emplace(std::move(key), true).second;
  };
  is_new(states.front());
  for (std::size_t at = 0; at < states.size() && at < limit; ++at) {
    for (const Step& step : enabled_steps(system, GlobalState(states[at]))) {
      const GlobalState next = apply(system, states[at], step);
      if (!next.is_cut && is_new(next)) states.push_back(next);
    }
  }
  return states;
}

Formula make_atom(Atom::Kind kind, std::uint32_t owner) {
  return make_formula(Atom{kind, owner, 0, Atom::any_program});
}

// "The shared variable is not 0", as an expression of the system.
Formula add_variable_atom(System& system) {
  Expression variable;
  variable.op = Expression::Operator::shared;
  variable.kind = ValueKind::boolean;
  variable.index = static_cast<std::uint32_t>(system.models.size() - 1);
  variable.name = "v";
  system.expressions.push_back(variable);
  return make_atom(Atom::Kind::expression, 0);
}

class JointSystems : public testing::TestWithParam<int> {
 protected:
  Random random_{static_cast<std::uint64_t>(400 + GetParam())};
};

TEST_P(JointSystems, TablesHaveTheStepsOfTheMeaning) {
  int joint_steps = 0;
  for (int i = 0; i < 600 && !HasFailure(); ++i) {
    const System system = test::random_joint_system(
        random_, {1, 3, 3, 0.3, 0.3}, i % 2 == 0 ? everything : everything_with_nobody);
    const PackedSystem packed(system);
    ASSERT_NO_THROW(packed.check_invariants()) << test::show(system);
    with_words(packed.words(), [&](auto words) {
      for (const GlobalState& state : reachable_states(system, 300)) {
        compare_steps<words.value>(packed, state);
        for (const Step& step : enabled_steps(system, state)) {
          joint_steps += step.targets.size() > 1 ? 1 : 0;
        }
      }
    });
    if (HasFailure()) ADD_FAILURE() << test::show(system);
  }
  EXPECT_GT(joint_steps, 300);
}

TEST_P(JointSystems, DeadlocksAndCutsAreShortest) {
  NativeEngine engine;
  int deadlocks = 0, cuts = 0, free = 0;
  for (int compared = 0; compared < 400 && !HasFailure();) {
    const System system = test::random_joint_system(
        random_, {1, 3, 3, 0.5, 0.7}, compared % 2 == 0 ? test::JointSystemKinds{} : with_nobody);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete()) continue;
    ++compared;
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      const PropertyResult result =
          engine.check(system, built_in(Property::Kind::deadlock), with(reduction));
      ASSERT_EQ(result.verdict == Verdict::violated, expected.shortest_deadlock().has_value())
          << to_string(reduction) << test::show(system);
      if (result.trace) {
        EXPECT_EQ(result.trace->steps.size(), *expected.shortest_deadlock());
      } else if (reduction == Reduction::none) {
        EXPECT_EQ(result.states, expected.states()) << test::show(system);
      }
      const CutResult cut = engine.find_cut(system, with(reduction));
      ASSERT_EQ(cut.verdict == Verdict::violated, expected.shortest_cut().has_value())
          << to_string(reduction) << test::show(system);
      if (cut.trace) {
        EXPECT_EQ(cut.trace->steps.size(), *expected.shortest_cut());
      }
    }
    deadlocks += expected.shortest_deadlock() ? 1 : 0;
    cuts += expected.shortest_cut() ? 1 : 0;
    free += expected.shortest_deadlock() ? 0 : 1;
  }
  EXPECT_GT(deadlocks, 10);
  EXPECT_GT(cuts, 3);
  EXPECT_GT(free, 10);
}

TEST_P(JointSystems, ErrorsDeathsAndRest) {
  NativeEngine engine;
  int deadlocks = 0, errors = 0, dead_only = 0;
  for (int compared = 0; compared < 400 && !HasFailure();) {
    const System system = test::random_joint_system(
        random_, {1, 3, 3, 0.5, 0.7}, compared % 2 == 0 ? everything : everything_with_nobody);
    const test::ExplicitChecker expected(system, node_limit);
    if (!expected.is_complete()) continue;
    ++compared;
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      const PropertyResult deadlock =
          engine.check(system, built_in(Property::Kind::deadlock), with(reduction));
      ASSERT_EQ(deadlock.verdict == Verdict::violated, expected.shortest_deadlock().has_value())
          << to_string(reduction) << test::show(system);
      if (deadlock.trace) {
        EXPECT_EQ(deadlock.trace->steps.size(), *expected.shortest_deadlock());
        const GlobalState last = replay(system, *deadlock.trace).back();
        dead_only += enabled_steps(system, last).empty() ? 0 : 1;
      } else if (reduction == Reduction::none) {
        EXPECT_EQ(deadlock.states, expected.states()) << test::show(system);
      }
      const PropertyResult error =
          engine.check(system, built_in(Property::Kind::error), with(reduction));
      ASSERT_EQ(error.verdict == Verdict::violated, expected.shortest_error().has_value())
          << to_string(reduction) << test::show(system);
      if (error.trace) {
        EXPECT_EQ(error.trace->steps.size(), *expected.shortest_error());
      }
      const CutResult cut = engine.find_cut(system, with(reduction));
      ASSERT_EQ(cut.verdict == Verdict::violated, expected.shortest_cut().has_value())
          << to_string(reduction) << test::show(system);
    }
    deadlocks += expected.shortest_deadlock() ? 1 : 0;
    errors += expected.shortest_error() ? 1 : 0;
  }
  EXPECT_GT(deadlocks, 10);
  EXPECT_GT(dead_only, 3);
  EXPECT_GT(errors, 10);
}

TEST_P(JointSystems, StuckPrograms) {
  NativeEngine engine;
  const test::JointSystemKinds kinds[] = {
      {},          {false, false, false, true}, {false, true, true, false}, everything,
      with_nobody, everything_with_nobody};
  int stuck = 0, starving = 0, beside_nobody = 0;
  for (int compared = 0; compared < 900 && !HasFailure();) {
    const System system =
        test::random_joint_system(random_, {2, 3, 3, 0.7, 0.9}, kinds[compared % 6]);
    if (!test::ExplicitChecker(system, 120).is_complete()) continue;
    ++compared;
    const bool expected = test::has_stuck_program(system);
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      const PropertyResult result =
          engine.check(system, built_in(Property::Kind::stuck), with(reduction));
      ASSERT_EQ(result.verdict == Verdict::violated, expected)
          << to_string(reduction) << test::show(system);
      starving += result.remarkable ? 1 : 0;
    }
    stuck += expected ? 1 : 0;
    beside_nobody += expected && !system.nobodys_actions.empty() ? 1 : 0;
  }
  EXPECT_GT(beside_nobody, 3);
  EXPECT_GT(stuck, 10);
  EXPECT_GT(starving, 3);
}

// G F and F G of "v is set", under each fairness, which groups are part of.
TEST_P(JointSystems, FairFormulas) {
  NativeEngine engine;
  constexpr Fairness all[] = {Fairness::none, Fairness::weak, Fairness::strong};
  int weak_helps = 0;
  for (int compared = 0; compared < 400 && !HasFailure();) {
    System system = test::random_joint_system(random_, {2, 3, 3, 0.9, 1},
                                              {.groups = true, .nobody = compared % 2 == 1});
    const Formula set = add_variable_atom(system);
    const test::ExplicitChecker expected(system, 200);
    if (!expected.is_complete()) continue;
    ++compared;
    using Operator = FormulaNode::Operator;
    for (const auto& [outer, inner] : {std::pair(Operator::globally, Operator::finally),
                                       std::pair(Operator::finally, Operator::globally)}) {
      Property property;
      property.name = "formula";
      property.formula = make_formula(outer, make_formula(inner, set));
      bool holds[3] = {};
      for (const Fairness fairness : all) {
        property.fairness = fairness;
        const auto label = expected.label(set);
        bool& is_true = holds[static_cast<int>(fairness)];
        is_true = outer == Operator::globally ? expected.holds_infinitely_often(label, fairness)
                                              : expected.holds_from_some_point(label, fairness);
        const PropertyResult result = engine.check(system, property, {});
        ASSERT_EQ(result.verdict == Verdict::holds, is_true)
            << "fairness " << static_cast<int>(fairness) << "\n"
            << test::show(system);
      }
      weak_helps += holds[1] && !holds[0] ? 1 : 0;
      EXPECT_LE(holds[1], holds[2]);  // the fairer the runs, the more holds
    }
  }
  EXPECT_GT(weak_helps, 0);
}

// A reduction changes no verdict.
TEST_P(JointSystems, FormulasAndReductions) {
  NativeEngine engine;
  int holds = 0, violated = 0;
  for (int compared = 0; compared < 100 && !HasFailure();) {
    System system = test::random_joint_system(random_, {1, 3, 3, 0.5, 0.7},
                                              compared % 4 == 0   ? test::JointSystemKinds{}
                                              : compared % 4 == 1 ? everything
                                              : compared % 4 == 2 ? with_nobody
                                                                  : everything_with_nobody);
    if (!test::ExplicitChecker(system, 300).is_complete()) continue;
    ++compared;
    const Formula is_set = add_variable_atom(system);
    const auto make = [](FormulaNode::Operator op, Formula left, Formula right = nullptr) {
      return make_formula(op, std::move(left), std::move(right));
    };
    using Operator = FormulaNode::Operator;
    const Formula gives = make_atom(Atom::Kind::input, 0), ends = make_atom(Atom::Kind::end, 0);
    const Formula formulas[] = {
        make(Operator::globally,
             make(Operator::disjunction, make(Operator::negation, is_set, nullptr),
                  make(Operator::negation, ends, nullptr))),
        make(Operator::globally, make(Operator::implication, is_set,
                                      make(Operator::finally, make(Operator::negation, is_set)))),
        make(Operator::finally, make(Operator::globally, make(Operator::negation, gives)))};
    for (const Formula& formula : formulas) {
      for (const Fairness fairness : {Fairness::none, Fairness::weak, Fairness::strong}) {
        Property property;
        property.name = "formula";
        property.formula = formula;
        property.fairness = fairness;
        const PropertyResult all = engine.check(system, property, {});
        ++(all.verdict == Verdict::holds ? holds : violated);
        for (const Reduction reduction : {Reduction::calls, Reduction::order, Reduction::full}) {
          EXPECT_EQ(engine.check(system, property, with(reduction)).verdict, all.verdict)
              << to_string(reduction) << test::show(system);
        }
      }
    }
  }
  EXPECT_GT(holds, 20);
  EXPECT_GT(violated, 20);
}

// Several threads and several ranks, which are told of the system, find what one thread does.
TEST_P(JointSystems, ThreadsAndRanksAgree) {
  NativeEngine engine;
  int violated = 0, holds = 0;
  for (int compared = 0; compared < 60 && !HasFailure();) {
    const System system = test::random_joint_system(
        random_, {2, 3, 3, 0.7, 0.9}, compared % 2 == 0 ? with_nobody : everything_with_nobody);
    if (!test::ExplicitChecker(system, 300).is_complete()) continue;
    ++compared;
    for (const Property::Kind kind : {Property::Kind::deadlock, Property::Kind::stuck}) {
      const PropertyResult one = engine.check(system, built_in(kind), with(Reduction::none));
      ++(one.verdict == Verdict::holds ? holds : violated);
      EngineOptions options = with(Reduction::none);
      options.threads = 3;
      options.states_a_thread = 2;
      const PropertyResult threads = engine.check(system, built_in(kind), options);
      EXPECT_EQ(threads.verdict, one.verdict) << test::show(system);
      test::RanksOfThreads ranks(2);
      options.threads = 1;
      options.ranks = ranks.first();
      const PropertyResult several = engine.check(system, built_in(kind), options);
      EXPECT_EQ(several.verdict, one.verdict) << test::show(system);
      if (one.verdict != Verdict::holds) continue;
      EXPECT_EQ(threads.states, one.states);
      EXPECT_EQ(several.states, one.states);
      EXPECT_EQ(several.transitions, one.transitions);
    }
  }
  EXPECT_GT(holds, 10);
  EXPECT_GT(violated, 10);
}

INSTANTIATE_TEST_SUITE_P(Seeds, JointSystems, testing::Range(0, 6));

}  // namespace
}  // namespace maide
