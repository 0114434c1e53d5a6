#include "maide/conformance/w_method.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/conformance/standard_method.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/mealy_oracle.hpp"
#include "maide/sul/ia_translator.hpp"
#include "small_machines.hpp"

namespace maide {
namespace {

std::vector<Word> list(TestSuite& suite, std::size_t limit = 1'000'000) {
  std::vector<Word> words;
  Word word;
  while (words.size() < limit && suite.next(word)) words.push_back(word);
  return words;
}

TEST(WSuite, SizeIsTheNumberOfTestsAndNoTestComesTwice) {
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const Mealy machine = random_mealy({.states = random.between(1, 8),
                                        .inputs = random.between(1, 3),
                                        .outputs = random.between(1, 3)},
                                       random);
    std::vector<Word> shallower;
    for (std::size_t extra = 0; extra < 3; ++extra) {
      WSuite suite(machine, extra);
      const std::vector<Word> words = list(suite);
      EXPECT_EQ(words.size(), suite.size());
      EXPECT_EQ(suite.class_count(), minimize(machine).size());
      // Few extra states come first.
      ASSERT_GE(words.size(), shallower.size());
      EXPECT_TRUE(std::equal(shallower.begin(), shallower.end(), words.begin()));
      EXPECT_EQ(suite.size_up_to(extra), words.size());
      shallower = words;
      if (suite.characterising_set().size() == 1) {
        EXPECT_EQ(std::set<Word>(words.begin(), words.end()).size(), words.size());
      }
    }
  }
}

TEST(WSuite, HugeSuitesAreCountedWithoutOverflow) {
  Random random(2);
  const Mealy machine = random_mealy({.states = 50, .inputs = 20, .outputs = 3}, random);
  WSuite suite(machine, 40);
  EXPECT_EQ(suite.size(), ~std::uint64_t{0});
  EXPECT_EQ(list(suite, 1000).size(), 1000U);
}

bool finds_difference(const Mealy& hypothesis, const Mealy& system, std::size_t extra) {
  MealyOracle oracle(system);
  WMethod method(oracle, {.extra_states = extra});
  const auto word = method.find_counterexample(hypothesis);
  if (word) {
    const Word expected = hypothesis.output_word(*word), real = system.output_word(*word);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end() - 1, real.begin()));
    EXPECT_NE(expected.back(), real.back()) << "not cut at the first difference";
  }
  return word.has_value();
}

// The theorem: with k extra states no system of at most n + k states passes that differs.
TEST(WMethod, FindsEveryDifferenceWithinItsExtraStates) {
  std::uint64_t found = 0, same = 0;
  for (std::uint64_t states = 1; states <= 2; ++states) {
    for (std::uint64_t number = 0; number < count_small_machines(states); number += 5) {
      const Mealy hypothesis = minimize(small_machine(states, number));
      for (std::uint64_t other = number % 7; other < count_small_machines(3); other += 61) {
        const Mealy system = small_machine(3, other);
        const bool differ = find_difference(hypothesis, system).has_value();
        ASSERT_EQ(finds_difference(hypothesis, system, 3 - hypothesis.size()), differ)
            << number << " of " << states << " against " << other;
        ++(differ ? found : same);
      }
    }
  }
  EXPECT_GT(found, 10'000U);
  EXPECT_GT(same, 10U);
}

// ... and fewer extra states do miss some, so the number matters.
TEST(WMethod, FewerExtraStatesMissSomething) {
  int missed = 0;
  for (std::uint64_t other = 0; other < count_small_machines(3); ++other) {
    const Mealy hypothesis = small_machine(1, 0), system = small_machine(3, other);
    if (find_difference(hypothesis, system) && !finds_difference(hypothesis, system, 0)) ++missed;
  }
  EXPECT_GT(missed, 100);
}

// Answers "1" to every third "a", whatever comes between.
Mealy counting_machine() {
  Mealy machine({"a", "b"}, {"0", "1"}, 3);
  for (StateId state = 0; state < 3; ++state) {
    machine.set_transition(state, 0, state == 2 ? 1 : 0, (state + 1) % 3);
    machine.set_transition(state, 1, 0, state);
  }
  return machine;
}

// Sizes of suites nobody could count: known at once, and what was tested is what is claimed.
TEST(WMethod, AnyNumberOfExtraStatesIsANumber) {
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  const Mealy machine = counting_machine();
  MealyOracle oracle(machine);
  WMethod cut(oracle, {.extra_states = most, .runner = {.max_tests = 1000}});
  EXPECT_FALSE(cut.find_counterexample(machine));
  EXPECT_NE(cut.guarantee().find("not refuted by 1000 tests"), std::string::npos);
  Mealy one({"a"}, {"0"}, 1);
  one.set_transition(0, 0, 0, 0);
  EXPECT_EQ(WSuite(one, 3).size_up_to(3), 1U + 4U);
  EXPECT_EQ(WSuite(one, most).size_up_to(most), most);
}

TEST(WMethod, SaysWhatItEstablishes) {
  const Mealy machine = counting_machine();
  MealyOracle oracle(machine);
  WMethod whole(oracle, {.extra_states = 2});
  EXPECT_EQ(whole.guarantee(), "not tested");
  whole.find_counterexample(machine);
  const std::uint64_t all = WSuite(machine, 2).size_up_to(2),
                      some = WSuite(machine, 2).size_up_to(1);
  EXPECT_EQ(whole.guarantee(), "not refuted by " + std::to_string(all) +
                                   " tests of the W-method: no other machine of at most 5 states "
                                   "(3 + 2 extra) passes them");
  WMethod cut(oracle, {.extra_states = 2, .runner = {.max_tests = all - 1}});
  cut.find_counterexample(machine);
  EXPECT_NE(cut.guarantee().find("at most 4 states (3 + 1 extra)"), std::string::npos)
      << cut.guarantee();
  WMethod less(oracle, {.extra_states = 2, .runner = {.max_tests = 2}});
  less.find_counterexample(machine);
  EXPECT_NE(less.guarantee().find("not refuted by 2 tests"), std::string::npos);
  EXPECT_NE(less.guarantee().find("cut off before"), std::string::npos) << less.guarantee();
  EXPECT_LT(some, all);
}

// The budget's promise, for the paper's queues: three extra states, and two in translation av.
TEST(StandardMethod, CoversTheQueuesOfThePaper) {
  for (const auto& entry : std::filesystem::directory_iterator(MAIDE_SOURCE_DIR "/tests/models")) {
    if (entry.path().extension() != ".dot") continue;
    const InterfaceAutomaton automaton = read_interface_automaton(entry.path());
    for (const Translation translation : {Translation::eager, Translation::av}) {
      const Mealy machine = to_mealy(automaton, translation);
      MealyOracle oracle(machine);
      StandardMethod method(oracle);
      EXPECT_EQ(method.find_counterexample(machine), std::nullopt);
      const std::string guarantee = method.guarantee();
      const bool three = guarantee.find("+ 3 extra") != std::string::npos;
      const bool two = guarantee.find("+ 2 extra") != std::string::npos;
      EXPECT_TRUE(three || (translation == Translation::av && two)) << entry.path() << guarantee;
      EXPECT_NE(guarantee.find("200 random words"), std::string::npos) << guarantee;
    }
  }
}

}  // namespace
}  // namespace maide
