#include "maide/automata/strength.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"

namespace maide {
namespace {

TEST(Strength, TextAndBack) {
  const Strength strengths[]{{},
                             {.extra_states = 0},
                             {.exact = true},
                             {.extra_states = 2, .chained = 3, .pumped = 64, .random = 4000}};
  for (const Strength& strength : strengths) {
    EXPECT_EQ(parse_strength(to_string(strength)), strength) << to_string(strength);
  }
  EXPECT_EQ(to_string(strengths[3]), "extra-states=2,chained=3,pumped=64,random=4000");
  EXPECT_EQ(parse_strength("pumped=5"), Strength{.pumped = 5});
}

TEST(Strength, AFileSaysWhetherItIsWeak) {
  for (const bool is_weak : {false, true}) {
    const StatedStrength stated{{.chained = 3, .random = 7}, is_weak};
    const auto read = find_strength({{"seed", "1"}, {"strength", to_string(stated)}});
    ASSERT_TRUE(read);
    EXPECT_EQ(read->strength, stated.strength);
    EXPECT_EQ(read->is_weak, is_weak);
  }
  EXPECT_EQ(to_string(StatedStrength{{.exact = true}, false}), "exact");
  EXPECT_EQ(to_string(StatedStrength{{}, true}), "weak: chained=0,pumped=0,random=0");
  EXPECT_FALSE(find_strength({{"seed", "1"}}));
  EXPECT_THROW(find_strength({{"strength", "weak"}}), UsageError);
  EXPECT_THROW(parse_stated_strength("weak: "), UsageError);
}

TEST(Strength, WhatIsNoneIsNamed) {
  for (const char* text :
       {"", "strong", "pumped", "pumped=", "pumped=-1", "pumped=1,", "depth=3"}) {
    EXPECT_THROW(parse_strength(text), UsageError) << text;
    EXPECT_THROW(parse_demand(text, {}), UsageError) << text;
  }
  EXPECT_THROW(parse_demand("exact", {}), UsageError);
  for (const char* text : {"pumped=18446744073709551615", "chained=33", "extra-states=1001",
                           "random=18446744073709551615"}) {
    EXPECT_THROW(parse_demand(text, {}), UsageError) << text;
  }
}

TEST(Strength, DemandGrowsWithTheMachineAndTheSizesOfTheSystem) {
  const StrengthDemand demand = default_demand(10, 5, 0);
  EXPECT_EQ(demand.random, 2000 + 20 * 10 * 5);
  EXPECT_EQ(demand.pumped, 64);
  EXPECT_EQ(default_demand(10, 5, 50).pumped, 100);
}

TEST(Strength, EachDimensionMakesAModelWeak) {
  const StrengthDemand demand = default_demand(10, 5, 0);
  const Strength enough{.extra_states = 1, .chained = 3, .pumped = 64, .random = 3000};
  EXPECT_EQ(describe_shortfall(enough, demand), "");
  EXPECT_EQ(describe_shortfall({.exact = true}, demand), "");
  Strength one = enough;
  one.extra_states = 0;
  EXPECT_EQ(describe_shortfall(one, demand), "extra-states=1");
  one.extra_states.reset();
  EXPECT_EQ(describe_shortfall(one, demand), "extra-states=1");
  one = enough;
  one.chained = 2;
  EXPECT_EQ(describe_shortfall(one, demand), "chained=3");
  one = enough;
  one.pumped = 63;
  EXPECT_EQ(describe_shortfall(one, demand), "pumped=64");
  one = enough;
  one.random = 2999;
  EXPECT_EQ(describe_shortfall(one, demand), "random=3000");
  one.extra_states = 3;  // stands in for random tests
  EXPECT_EQ(describe_shortfall(one, demand), "");
  EXPECT_EQ(describe_shortfall({}, demand), "extra-states=1,chained=3,pumped=64,random=3000");
}

TEST(Strength, NoExtraStatesAreMoreThanNothing) {
  const StrengthDemand demand = parse_demand("extra-states=0", {});
  EXPECT_EQ(
      describe_shortfall({.extra_states = 0, .chained = 3, .pumped = 64, .random = 2000}, demand),
      "");
  EXPECT_EQ(describe_shortfall({.chained = 3, .pumped = 64, .random = 2000}, demand),
            "extra-states=0");
}

}  // namespace
}  // namespace maide
