#include "maide/conformance/method/complete_method.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/suite/identifier_suite.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/sul/ia_translator.hpp"
#include "small_machines.hpp"
#include "suite_words.hpp"

namespace maide {
namespace {

using test::list;

constexpr IdentifierMethod methods[] = {w_identifiers, wp_identifiers, hsi_identifiers,
                                        hads_identifiers};

IdentifierSuite make_suite(const Mealy& machine, const IdentifierMethod& method,
                           std::size_t extra) {
  return {machine, method.compute(machine, Random(0)), extra};
}

// A random machine in which output 0 ends the session: all such transitions lead to a state that
// answers output 1 to everything.
Mealy machine_with_end(Random& random) {
  Mealy machine = random_mealy({.states = random.between(2, 7),
                                .inputs = random.between(1, 3),
                                .outputs = random.between(2, 4)},
                               random);
  const StateId end = machine.add_state();
  for (StateId state = 0; state <= end; ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      if (state == end) {
        machine.set_transition(state, input, 1, end);
      } else if (machine.output(state, input) == 0) {
        machine.set_transition(state, input, 0, end);
      }
    }
  }
  return minimize(machine);
}

// Its tests are those of the whole suite, cut behind the end of the session, and counted right.
TEST(IdentifierSuite, LeavesOutWhatComesBehindTheEndOfASession) {
  Random random(3);
  std::size_t left_out = 0;
  for (int i = 0; i < 60; ++i) {
    const Mealy machine = machine_with_end(random);
    std::vector<bool> is_error(machine.outputs().size());
    is_error[0] = true;
    const auto cut = [&](const std::vector<Word>& words) {
      std::set<Word> result;
      for (const Word& word : words) {
        const Word outputs = machine.output_word(word);
        const auto end = std::find(outputs.begin(), outputs.end(), 0);
        const auto length = static_cast<std::size_t>(end - outputs.begin());
        result.insert(head(word, std::min(length + 1, word.size())));
      }
      return result;
    };
    for (const IdentifierMethod& method : methods) {
      for (std::size_t extra = 0; extra < 3; ++extra) {
        IdentifierSuite whole = make_suite(machine, method, extra);
        IdentifierSuite suite(machine, method.compute(machine, Random(0)), extra, is_error);
        const std::vector<Word> all = list(whole), words = list(suite);
        EXPECT_EQ(cut(words), cut(all)) << method.title;
        EXPECT_EQ(words.size(), suite.size()) << method.title;
        std::uint64_t symbols = 0;
        for (const Word& word : words) symbols += word.size();
        EXPECT_EQ(symbols, suite.symbols()) << method.title;
        EXPECT_EQ(suite.complete_for(), extra);
        EXPECT_LE(words.size(), all.size());
        left_out += all.size() - words.size();
      }
    }
  }
  EXPECT_GT(left_out, 1000U);
}

TEST(IdentifierSuite, IsCountedBeforeItRuns) {
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const Mealy machine = random_mealy({.states = random.between(1, 8),
                                        .inputs = random.between(1, 3),
                                        .outputs = random.between(1, 3)},
                                       random);
    for (const IdentifierMethod& method : methods) {
      std::vector<Word> shallower;
      for (std::size_t extra = 0; extra < 3; ++extra) {
        IdentifierSuite suite = make_suite(machine, method, extra);
        EXPECT_EQ(suite.complete_for(), std::nullopt);
        const std::vector<Word> words = list(suite);
        EXPECT_EQ(suite.complete_for(), extra);
        EXPECT_EQ(words.size(), suite.size()) << method.title;
        std::uint64_t symbols = 0;
        for (const Word& word : words) symbols += word.size();
        EXPECT_EQ(symbols, suite.symbols()) << method.title;
        // Few extra states come first.
        ASSERT_GE(words.size(), shallower.size());
        EXPECT_TRUE(std::equal(shallower.begin(), shallower.end(), words.begin()));
        EXPECT_EQ(suite.size_up_to(extra), words.size());
        shallower = words;
      }
    }
  }
}

TEST(IdentifierSuite, HugeSuitesAreCountedWithoutOverflow) {
  Random random(2);
  const Mealy machine = random_mealy({.states = 50, .inputs = 20, .outputs = 3}, random);
  for (const IdentifierMethod& method : methods) {
    IdentifierSuite suite = make_suite(machine, method, 40);
    EXPECT_EQ(suite.size(), ~std::uint64_t{0});
    EXPECT_EQ(suite.symbols(), ~std::uint64_t{0});
    EXPECT_EQ(list(suite, 1000).size(), 1000U);
  }
}

TEST(IdentifierSuite, EachMethodNeedsFewerTestsThanW) {
  Random random(3);
  const Mealy machine = minimize(random_mealy({.states = 60, .inputs = 4, .outputs = 2}, random));
  const std::uint64_t w = *make_suite(machine, w_identifiers, 1).size();
  EXPECT_LT(make_suite(machine, wp_identifiers, 1).size(), w);
  EXPECT_LT(make_suite(machine, hsi_identifiers, 1).size(), w);
  EXPECT_LT(*make_suite(machine, hads_identifiers, 1).size() * 2, w);
}

bool finds_difference(const Mealy& hypothesis, const Mealy& system, const IdentifierMethod& method,
                      std::size_t extra) {
  MealyOracle oracle(system);
  CompleteMethod tests(oracle, method, {.extra_states = extra});
  const auto word = tests.find_counterexample(hypothesis);
  if (word) {
    const Word expected = hypothesis.output_word(*word), real = system.output_word(*word);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end() - 1, real.begin()));
    EXPECT_NE(expected.back(), real.back()) << "not cut at the first difference";
  }
  return word.has_value();
}

// The theorem: with k extra states no system of at most n + k states passes that differs.
TEST(CompleteMethod, FindsEveryDifferenceWithinItsExtraStates) {
  for (const IdentifierMethod& method : methods) {
    std::uint64_t found = 0, same = 0;
    for (std::uint64_t states = 1; states <= 2; ++states) {
      for (std::uint64_t number = 0; number < count_small_machines(states); number += 5) {
        const Mealy hypothesis = minimize(small_machine(states, number));
        for (std::uint64_t other = number % 7; other < count_small_machines(3); other += 61) {
          const Mealy system = small_machine(3, other);
          const bool differ = find_difference(hypothesis, system).has_value();
          ASSERT_EQ(finds_difference(hypothesis, system, method, 3 - hypothesis.size()), differ)
              << method.title << ", " << number << " of " << states << " against " << other;
          ++(differ ? found : same);
        }
      }
    }
    EXPECT_GT(found, 10'000U);
    EXPECT_GT(same, 10U);
  }
}

// ... for larger machines, of which the system is a mutant: some transitions lead elsewhere, some
// of them to new states.
TEST(CompleteMethod, FindsEveryMutantWithinItsExtraStates) {
  Random random(4);
  std::uint64_t found = 0;
  for (int i = 0; i < 600; ++i) {
    const Mealy hypothesis = minimize(
        random_mealy({.states = random.between(2, 12), .inputs = 2, .outputs = 2}, random));
    const std::size_t extra = random.between(0, 2);
    Mealy system = hypothesis;
    for (std::size_t added = 0; added < extra; ++added) {
      const StateId model = static_cast<StateId>(random.below(hypothesis.size()));
      const StateId copy = system.add_state();
      for (Symbol input = 0; input < 2; ++input) {
        system.set_transition(copy, input, system.output(model, input),
                              system.target(model, input));
      }
    }
    for (std::uint64_t changed = random.between(1, 2 + extra); changed > 0; --changed) {
      const auto from = static_cast<StateId>(random.below(system.size()));
      const auto input = static_cast<Symbol>(random.below(2));
      system.set_transition(from, input, system.output(from, input),
                            static_cast<StateId>(random.below(system.size())));
    }
    const bool differ = find_difference(hypothesis, system).has_value();
    for (const IdentifierMethod& method : methods) {
      ASSERT_EQ(finds_difference(hypothesis, system, method, extra), differ) << method.title;
    }
    found += differ ? 1 : 0;
  }
  EXPECT_GT(found, 200U);
}

// All states of the system lie within so many inputs of those that the words reach.
bool is_near(const Mealy& system, const std::vector<Word>& cover, std::size_t steps) {
  std::set<StateId> reached, all{system.initial()};
  for (const Word& word : cover) reached.insert(system.run(word));
  const auto grow = [&](std::set<StateId>& states) {
    std::set<StateId> grown = states;
    for (const StateId state : states) {
      for (Symbol input = 0; input < system.inputs().size(); ++input) {
        grown.insert(system.target(state, input));
      }
    }
    states = grown;
  };
  for (std::size_t i = 0; i < system.size(); ++i) grow(all);
  for (std::size_t i = 0; i < steps; ++i) grow(reached);
  return reached == all;
}

// The stronger theorem (Vaandrager & Melse): the system may have any number of states more, if all
// lie within k inputs of the state cover's.
TEST(CompleteMethod, FindsEveryDifferenceNearTheStateCover) {
  Random random(5);
  std::uint64_t larger = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Mealy hypothesis = small_machine(2, random.below(count_small_machines(2)));
    if (minimize(hypothesis).size() < 2) continue;
    Mealy drawn({"a", "b"}, {"0", "1"}, random.between(3, 8));
    for (StateId state = 0; state < drawn.size(); ++state) {
      for (Symbol input = 0; input < 2; ++input) {
        drawn.set_transition(state, input, static_cast<Symbol>(random.below(2)),
                             static_cast<StateId>(random.below(drawn.size())));
      }
    }
    const Mealy system = minimize(drawn);
    const std::size_t steps = random.between(1, 2);
    if (!is_near(system, compute_state_cover(hypothesis), steps)) continue;
    if (system.size() > 2 + steps) ++larger;
    const bool differ = find_difference(hypothesis, system).has_value();
    for (const IdentifierMethod& method : methods) {
      ASSERT_EQ(finds_difference(hypothesis, system, method, steps), differ) << method.title;
    }
  }
  EXPECT_GT(larger, 500U);
}

// ... and fewer extra states do miss some, so the number matters.
TEST(CompleteMethod, FewerExtraStatesMissSomething) {
  for (const IdentifierMethod& method : methods) {
    int missed = 0;
    for (std::uint64_t other = 0; other < count_small_machines(3); ++other) {
      const Mealy hypothesis = small_machine(1, 0), system = small_machine(3, other);
      if (find_difference(hypothesis, system) && !finds_difference(hypothesis, system, method, 0)) {
        ++missed;
      }
    }
    EXPECT_GT(missed, 100) << method.title;
  }
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
TEST(CompleteMethod, AnyNumberOfExtraStatesIsANumber) {
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  const Mealy machine = counting_machine();
  MealyOracle oracle(machine);
  WMethod cut(oracle, {.extra_states = most, .runner = {.max_tests = 1000}});
  EXPECT_FALSE(cut.find_counterexample(machine));
  EXPECT_NE(cut.guarantee().find("not refuted by 1000 tests"), std::string::npos);
  Mealy one({"a"}, {"0"}, 1);
  one.set_transition(0, 0, 0, 0);
  EXPECT_EQ(make_suite(one, w_identifiers, 3).size_up_to(3), 1U + 4U);
  EXPECT_EQ(make_suite(one, w_identifiers, most).size(), most);
}

TEST(CompleteMethod, SaysWhatItEstablishes) {
  const Mealy machine = counting_machine();
  MealyOracle oracle(machine);
  WMethod whole(oracle, {.extra_states = 2});
  EXPECT_EQ(whole.guarantee(), "not tested");
  whole.find_counterexample(machine);
  const IdentifierSuite suite = make_suite(machine, w_identifiers, 2);
  const std::uint64_t all = suite.size_up_to(2), some = suite.size_up_to(1);
  EXPECT_EQ(whole.guarantee(), "not refuted by " + std::to_string(all) +
                                   " tests of the W-method: no machine with at most 2 more "
                                   "states (5 in all) behaves differently");
  WMethod cut(oracle, {.extra_states = 2, .runner = {.max_tests = all - 1}});
  cut.find_counterexample(machine);
  EXPECT_NE(cut.guarantee().find("at most 1 more state (4 in all) behaves differently"),
            std::string::npos)
      << cut.guarantee();
  WMethod less(oracle, {.extra_states = 2, .runner = {.max_tests = 2}});
  less.find_counterexample(machine);
  EXPECT_NE(less.guarantee().find("not refuted by 2 tests"), std::string::npos);
  EXPECT_NE(less.guarantee().find("cut off before"), std::string::npos) << less.guarantee();
  EXPECT_LT(some, all);
}

}  // namespace
}  // namespace maide
