// Tests that pass states and transitions in every order.
#include "maide/conformance/suite/coverage_suite.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide {
namespace {

using Pairs = std::set<std::pair<std::uint64_t, std::uint64_t>>;

// What a word passes, in its order: states, or transitions as state x inputs + input.
std::vector<std::uint64_t> passed(const Mealy& machine, Covered covered, const Word& word) {
  std::vector<std::uint64_t> all;
  StateId state = machine.initial();
  if (covered == Covered::states) all.push_back(state);
  for (const Symbol input : word) {
    const std::uint64_t transition = std::uint64_t{state} * machine.inputs().size() + input;
    state = machine.target(state, input);
    all.push_back(covered == Covered::states ? state : transition);
  }
  return all;
}

Mealy ring(std::size_t states) {
  Mealy machine({"on", "stay"}, {"x"}, states);
  for (StateId state = 0; state < states; ++state) {
    machine.set_transition(state, 0, 0, static_cast<StateId>((state + 1) % states));
    machine.set_transition(state, 1, 0, state);
  }
  return machine;
}

TEST(CoverageSuite, PassesEachPairInEachOrder) {
  const Mealy machine = ring(5);
  for (const Covered covered : {Covered::states, Covered::transitions}) {
    const std::uint64_t targets = covered == Covered::states ? 5 : 10;
    CoverageSuite suite(machine, {.covered = covered, .ways = 2, .walk_length = 0}, Random(1));
    EXPECT_EQ(suite.size(), targets * targets);
    Pairs pairs;
    std::uint64_t tests = 0;
    for (Word word; suite.next(word); ++tests) {
      const auto all = passed(machine, covered, word);
      EXPECT_LE(word.size(), 2 * 5U);  // shortest paths, and two transitions
      for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i; j < all.size(); ++j) {
          if (covered == Covered::states || i < j) pairs.emplace(all[i], all[j]);
        }
      }
    }
    EXPECT_EQ(tests, *suite.size());
    EXPECT_EQ(pairs.size(), *suite.size());
  }
}

TEST(CoverageSuite, WalksGoOnFromTheSameStates) {
  const Mealy machine = ring(4);
  CoverageSuite suite(machine, {.walks = 3, .walk_length = 2}, Random(1));
  EXPECT_EQ(suite.size(), 12U);
  std::multiset<std::size_t> lengths;
  for (Word word; suite.next(word);) lengths.insert(word.size());
  EXPECT_EQ(lengths, (std::multiset<std::size_t>{2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5}));
}

TEST(CoverageSuite, ASmallPartOfItPassesMostStates) {
  const Mealy machine = ring(50);
  CoverageSuite suite(machine, {.ways = 2, .walk_length = 0}, Random(3));
  std::set<StateId> ends;
  Word word;
  for (int i = 0; i < 100 && suite.next(word); ++i) ends.insert(machine.run(word));
  EXPECT_GT(ends.size(), 30U);
}

TEST(CoverageSuite, GoesOnWhereAStateCannotBeReached) {
  Mealy machine({"on"}, {"x"}, 3);  // 0, 1, 2 for good
  for (StateId state = 0; state < 3; ++state) {
    machine.set_transition(state, 0, 0, std::min(state + 1, 2U));
  }
  CoverageSuite suite(machine, {.ways = 2, .walk_length = 4}, Random(1));
  std::multiset<std::size_t> lengths;
  for (Word word; suite.next(word);) lengths.insert(word.size());
  // Pairs that go on end in the second state, the three others in the first: 4 random inputs later.
  EXPECT_EQ(lengths, (std::multiset<std::size_t>{4, 5, 5, 5, 6, 6, 6, 6, 6}));
}

TEST(CoverageSuite, ASeedMeansASuiteAndHugeOnesCanBeBegun) {
  Random random(1);
  const Mealy machine = random_mealy({.states = 3000, .inputs = 2, .outputs = 3}, random);
  const CoverageOptions options{.covered = Covered::transitions, .ways = 6};
  CoverageSuite suite(machine, options, Random(1)), again(machine, options, Random(1));
  EXPECT_EQ(suite.size(), std::numeric_limits<std::uint64_t>::max());
  Word word, same;
  for (int i = 0; i < 1000; ++i) {  // more states than shortest paths are kept from
    ASSERT_TRUE(suite.next(word));
    ASSERT_TRUE(again.next(same));
    ASSERT_EQ(word, same);
  }
}

// "on" is answered otherwise in place 5 once "stay" was given in place 3, and later in place 1.
TEST(CoverageMethod, FindsWhatTakesThreeTransitionsAndSaysWhatItDid) {
  const Mealy hypothesis = ring(6);
  Mealy system({"on", "stay"}, {"x", "y"}, 18);  // round x 6 + place
  for (StateId state = 0; state < 18; ++state) {
    const StateId round = state / 6, place = state % 6;
    system.set_transition(state, 0, round == 2 && place == 5 ? 1 : 0, round * 6 + (place + 1) % 6);
    const StateId next = place == 3 && round == 0   ? state + 6
                         : place == 1 && round == 1 ? state + 6
                                                    : state;
    system.set_transition(state, 1, 0, next);
  }
  MealyOracle oracle(system);
  const auto test = [&](CoverageOptions options, TestRunnerOptions runner = {}) {
    CoverageMethod method(oracle, options, runner, 1);
    const bool is_found = method.find_counterexample(hypothesis).has_value();
    return std::pair(is_found, method.guarantee());
  };
  EXPECT_EQ(test({.covered = Covered::transitions, .ways = 1, .walk_length = 0}),
            std::pair(false, std::string("not refuted by 12 tests for each transition")));
  EXPECT_EQ(test({.ways = 2, .walk_length = 0}, {.max_tests = 7}),
            std::pair(false, std::string("not refuted by 7 of 36 tests for each 2 states "
                                         "in each order")));
  EXPECT_EQ(test({.covered = Covered::transitions, .ways = 3, .walk_length = 0}),
            std::pair(true, std::string("refuted by a test of those for each 3 transitions "
                                        "in each order")));
}

TEST(CoverageSuite, DrawsWhatCannotBeCounted) {
  const Mealy machine = ring(10);
  CoverageSuite suite(machine, {.ways = 30, .walk_length = 0}, Random(1));
  Word word;
  std::size_t inputs = 0;
  for (int i = 0; i < 100 && suite.next(word); ++i) inputs += word.size();
  EXPECT_NEAR(static_cast<double>(inputs), 100 * 30 * 4.5, 1000);  // on average 4.5 to the next
  MealyOracle oracle(machine);
  CoverageMethod method(oracle, {.ways = 30, .walk_length = 0}, {.max_tests = 5}, 1);
  EXPECT_EQ(method.find_counterexample(machine), std::nullopt);
  EXPECT_EQ(method.guarantee(),
            "not refuted by 5 of more than 2^64 tests for each 30 states in each order");
}

TEST(CoverageMethod, RefusesWhatCannotBe) {
  const Mealy machine = ring(2);
  MealyOracle oracle(machine);
  for (const CoverageOptions& options :
       {CoverageOptions{.ways = 0}, CoverageOptions{.walks = 0}, CoverageOptions{.ways = 101},
        CoverageOptions{.walk_length = 1'000'001}}) {
    EXPECT_THROW(CoverageMethod(oracle, options, {}, 1), UsageError);
  }
}

}  // namespace
}  // namespace maide
