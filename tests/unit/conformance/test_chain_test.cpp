// Rows of methods as a user types them.
#include "maide/conformance/method/test_chain.hpp"

#include <gtest/gtest.h>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

Mealy example() {
  Random random(1);
  return minimize(random_mealy({.states = 8, .inputs = 3, .outputs = 2}, random));
}

TestMethodOptions at_most(std::uint64_t tests) {
  TestMethodOptions options;
  options.max_tests = tests;
  return options;
}

std::uint64_t count_tests(const std::string& chain, const TestMethodOptions& options = {}) {
  const Mealy machine = example();
  MealyOracle system(machine);
  CountingOracle counter(system);
  const auto oracle = TestChain(chain).make({counter, nullptr, &machine}, options);
  EXPECT_EQ(oracle->find_counterexample(machine), std::nullopt);
  return counter.statistics().total().queries;
}

TEST(TestChain, LinksHaveOptionsOfTheirOwn) {
  EXPECT_EQ(count_tests("random-words:max-tests=5"), 5U);
  EXPECT_EQ(count_tests("random-words:max_tests=5:min-length=2,random-hads:max-tests=7"), 12U);
  EXPECT_EQ(count_tests("random-words:max-tests=5,random-walk", at_most(3)), 8U);
  EXPECT_EQ(count_tests("perfect"), 0U);
  const std::uint64_t one = count_tests("hads:extra-states=1");
  EXPECT_EQ(count_tests("hads:extra-states=1,random-wp:max-tests=1:infix-inputs=uniform"), one + 1);
  EXPECT_GT(count_tests("hads:extra-states=2"), one);
}

TEST(TestChain, TheCacheComesFirstAndCanBeAlone) {
  const Mealy machine = example();
  MealyOracle system(machine);
  Cache cache(system);
  for (const std::string text : {"cache", "cache,random-words", "random-words"}) {
    const auto oracle = TestChain(text).make({cache, &cache, nullptr}, at_most(4));
    EXPECT_EQ(oracle->find_counterexample(machine), std::nullopt);
    EXPECT_TRUE(oracle->guarantee().starts_with("consistent with")) << oracle->guarantee();
    EXPECT_EQ(oracle->guarantee().find("consistent", 1), std::string::npos);
    EXPECT_EQ(oracle->guarantee().find("random words") != std::string::npos, text != "cache");
  }
  const auto perfect = TestChain("perfect").make({cache, &cache, &machine}, {});
  EXPECT_EQ(perfect->guarantee(), "equivalent to the reference model");
}

TEST(TestChain, RefusesWhatItCannotRead) {
  EXPECT_EQ(TestChain("").text(), "standard");
  for (const std::string text :
       {"magic", ",", "w,", "w:", "w:extra-states", "w:extra-states=", "w:extra-states=-1",
        "w:infix-min=1", "cache:seed=1", "perfect:max-tests=1", "random-hads:infix-mean=x",
        "random-hads:infix-inputs=often", "random-w:prefix-states=near", "hads:suffix-words=none",
        "random-w:suffix-words=all", "w:extra-states=1:=2", "k-way:ways=x", "k-way:extra-states=1",
        "random-walk:seed=1.5"}) {
    EXPECT_THROW(TestChain chain(text), UsageError) << text;
  }
}

TEST(TestChain, RequiresThatSomeMethodLooksAtAnOption) {
  const TestChain chain("cache,w:extra-states=1,random-w");
  for (const char* option : {"extra-states", "infix-mean", "max-tests"}) {
    EXPECT_NO_THROW(chain.require(option)) << option;
  }
  for (const char* option : {"ways", "infix", "mean"}) {
    EXPECT_THROW(chain.require(option), UsageError) << option;
  }
  EXPECT_TRUE(chain.has("w"));
  EXPECT_FALSE(chain.has("hads"));
  EXPECT_FALSE(chain.has("cache"));
}

TEST(TransitionCover, TakesEveryPathOnceAndClaimsNothing) {
  const Mealy machine = example();
  const std::uint64_t paths = machine.size() * 3 + 1;  // each transition, and the empty word
  EXPECT_EQ(count_tests("transition-cover:extra-states=0"), paths);
  MealyOracle system(machine);
  const auto oracle =
      TestChain("transition-cover:extra-states=0").make({system, nullptr, nullptr}, {});
  oracle->find_counterexample(machine);
  EXPECT_EQ(oracle->guarantee(),
            "not refuted by " + std::to_string(paths) + " tests of transition cover");
}

}  // namespace
}  // namespace maide
