// The default method: how strong it says it is, what it finds, and what it gives back.
#include "maide/conformance/method/standard_method.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/automata/compare.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/conformance/suite/identifier_suite.hpp"
#include "maide/conformance/suite/loop_suites.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

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
      const std::size_t extra = translation == Translation::eager ? 3 : 2;
      EXPECT_GE(method.strength().extra_states, extra) << entry.path() << method.guarantee();
      const StrengthDemand demand = default_demand(machine.size(), machine.inputs().size(), 0);
      EXPECT_EQ(describe_shortfall(method.strength(), demand), "") << entry.path();
      EXPECT_EQ(method.cost_of_missing().words, 0U) << entry.path();
    }
  }
}

// A lock: the right inputs in order; everything else leads to its end.
Mealy lock(std::size_t length, std::size_t inputs) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < inputs; ++i) names.push_back("i" + std::to_string(i));
  Mealy machine(Alphabet(names), {"no", "yes"}, length + 1);
  const auto end = static_cast<StateId>(length);
  for (StateId state = 0; state <= end; ++state) {
    for (Symbol input = 0; input < inputs; ++input) {
      const bool is_right = state < length && input == (state * 7 + 3) % inputs;
      machine.set_transition(state, input, is_right ? 1 : 0, is_right ? state + 1 : end);
    }
  }
  return machine;
}

// Most hypotheses are refuted by the random tests that come first; what those hardly find is found
// by the suite before all random tests are done.
TEST(StandardMethod, BeginsWithRandomTestsAndThenTakesTurns) {
  const Mealy machine = lock(100, 30);
  const std::uint64_t head_start = machine.size() * 30;
  const std::uint64_t complete =
      IdentifierSuite(machine, hads_identifiers.compute(machine, Random(0)), 0).size_up_to(0);
  const auto count_tests = [&](StateId from, Symbol input) {
    Mealy system = machine;
    const Mealy::Cell cell = machine.row(from)[input];
    system.set_transition(from, input, 1 - cell.output, cell.target);
    MealyOracle oracle(system);
    CountingOracle counter(oracle);
    StandardMethod method(counter, {.batch_size = 1});
    EXPECT_TRUE(method.find_counterexample(machine));
    EXPECT_EQ(method.guarantee(), "refuted by a test");
    return counter.statistics().total().queries;
  };
  EXPECT_LT(count_tests(0, 3), 10U);
  std::uint64_t later = 0;
  for (StateId state = 0; state < 100; state += 5) {
    const std::uint64_t tests = count_tests(state, 0);
    EXPECT_LE(tests, head_start + 2 * complete);
    later += tests > head_start ? 1 : 0;
  }
  EXPECT_GT(later, 0U);
}

// Which tests were missing is said, and what they would cost.
TEST(StandardMethod, IsWeakWhereTheBudgetEnds) {
  const Mealy machine = lock(12, 4);
  MealyOracle oracle(machine);
  StandardMethod enough(oracle);
  EXPECT_EQ(enough.find_counterexample(machine), std::nullopt);
  const StrengthDemand demand = default_demand(machine.size(), 4, 0);
  EXPECT_EQ(describe_shortfall(enough.strength(), demand), "");
  EXPECT_EQ(enough.cost_of_missing().words, 0U);
  EXPECT_NE(enough.guarantee().find("at most 2 more states (15 in all) behaves differently"),
            std::string::npos)
      << enough.guarantee();

  StandardMethod little(oracle, {.max_tests = 50});
  EXPECT_EQ(little.find_counterexample(machine), std::nullopt);
  EXPECT_EQ(describe_shortfall(little.strength(), demand).find("extra-states=1"), 0U);
  EXPECT_LE(little.strength().random, 50U);
  EXPECT_LT(little.strength().extra_states, std::optional<std::size_t>(1));
  EXPECT_GT(little.cost_of_missing().words, 3000U);
  EXPECT_GT(little.cost_of_missing().symbols, little.cost_of_missing().words);

  StandardMethod few_symbols(oracle, {.budget = {1'000'000, 1000}});
  EXPECT_EQ(few_symbols.find_counterexample(machine), std::nullopt);
  EXPECT_NE(describe_shortfall(few_symbols.strength(), demand), "");
}

TEST(StandardMethod, ReachesWhatIsDemanded) {
  const Mealy machine = lock(5, 3);
  MealyOracle oracle(machine);
  StandardMethod method(oracle, {.strength = "extra-states=5,chained=4,pumped=100,random=7"});
  EXPECT_EQ(method.find_counterexample(machine), std::nullopt);
  EXPECT_EQ(method.strength().extra_states, std::optional<std::size_t>(5));
  EXPECT_EQ(method.strength().chained, 4U);
  EXPECT_EQ(method.strength().pumped, 100U);
  EXPECT_THROW(StandardMethod(oracle, {.strength = "very"}), UsageError);
}

TEST(StandardMethod, PumpsTwiceTheLargestSize) {
  const Mealy machine = lock(5, 3);
  MealyOracle oracle(machine);
  StandardMethod method(oracle, {.sizes = {10, 80}});
  EXPECT_EQ(method.find_counterexample(machine), std::nullopt);
  EXPECT_EQ(method.strength().pumped, 160U);
}

// However much is demanded, no word is longer than a wrapper can read, and the budget ends it.
TEST(StandardMethod, StaysWithinItsBudgetWhateverIsDemanded) {
  const Mealy machine = lock(3, 3);
  MealyOracle oracle(machine);
  CountingOracle counter(oracle);
  const TestCost budget{100'000, 1'000'000};
  StandardMethod method(counter, {.budget = budget,
                                  .strength = "pumped=1000000,chained=32",
                                  .sizes = {7, 400'000, 1'000'000'000}});
  EXPECT_EQ(method.find_counterexample(machine), std::nullopt);
  EXPECT_LE(counter.statistics().total().symbols, budget.symbols + longest_test);
  EXPECT_LT(method.strength().pumped, 1'000'000U);
  EXPECT_GT(method.strength().pumped, 64U);
  EXPECT_LT(method.strength().chained, 32U);
  EXPECT_GT(method.cost_of_missing().symbols, budget.symbols);
}

// Answers so many words, and then no more.
class TiringOracle : public OracleDecorator {
 public:
  TiringOracle(OutputOracle& system, std::uint64_t words) : OracleDecorator(system), left_(words) {}
  using OutputOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override {
    if (left_ < batch.size()) throw Interrupted("interrupted");
    left_ -= batch.size();
    return system_.ask(batch, control, on_early_end);
  }

 private:
  std::uint64_t left_;
};

// Whenever a query is ended, each number is none, or the one that it comes to in the end.
TEST(StandardMethod, KeepsWhatItEstablishedWhenItIsEnded) {
  const Mealy machine = lock(5, 3);
  MealyOracle oracle(machine);
  CountingOracle counter(oracle);
  StandardMethod whole(counter);
  EXPECT_EQ(whole.find_counterexample(machine), std::nullopt);
  const Strength strength = whole.strength();
  const std::uint64_t words = counter.statistics().total().queries;
  Strength before;
  for (const std::uint64_t missing : {words, words / 2, words / 4, words / 8, words / 16,
                                      words / 32, words / 64, std::uint64_t{1}}) {
    TiringOracle tired(oracle, words - missing);
    StandardMethod method(tired);
    EXPECT_THROW(method.find_counterexample(machine), Interrupted);
    const Strength kept = method.strength();
    EXPECT_TRUE(kept.extra_states == std::nullopt || kept.extra_states == strength.extra_states);
    EXPECT_TRUE(kept.random == 0 || kept.random == strength.random);
    EXPECT_TRUE(kept.chained == 0 || kept.chained == strength.chained);
    EXPECT_TRUE(kept.pumped == 0 || kept.pumped == strength.pumped);
    EXPECT_GE(kept.chained, before.chained);
    before = kept;
  }
  EXPECT_EQ(before.extra_states, strength.extra_states);
  EXPECT_EQ(before.chained, strength.chained);
  Mealy wrong = machine;
  wrong.set_transition(2, 0, 1, 2);
  StandardMethod method(oracle);
  ASSERT_NE(method.find_counterexample(wrong), std::nullopt);
  EXPECT_EQ(method.strength(), Strength{});
}

// A strength is that of the last query.
TEST(StandardMethod, ARefutedHypothesisHasNoStrength) {
  const Mealy machine = lock(5, 3);
  MealyOracle oracle(machine);
  StandardMethod method(oracle);
  EXPECT_EQ(method.find_counterexample(machine), std::nullopt);
  Mealy wrong = machine;
  wrong.set_transition(2, 0, 1, 2);
  EXPECT_NE(method.find_counterexample(wrong), std::nullopt);
  EXPECT_EQ(method.strength(), Strength{});
}

// A buffer: `put` up to so often, `take` as often.
Mealy buffer(std::size_t size) {
  Mealy machine({"put", "take"}, {"ok", "full", "empty"}, size + 1);
  for (StateId state = 0; state <= size; ++state) {
    const bool is_full = state == size, is_empty = state == 0;
    machine.set_transition(state, 0, is_full ? 1 : 0, is_full ? state : state + 1);
    machine.set_transition(state, 1, is_empty ? 2 : 0, is_empty ? state : state - 1);
  }
  return machine;
}

// One counterexample shows all of a buffer, whether its size is named or its row is seen to go on.
TEST(StandardMethod, GuessesThatARowGoesOn) {
  for (const bool is_named : {true, false}) {
    const Mealy machine = buffer(60);
    MealyOracle oracle(machine);
    Cache cache(oracle);
    StandardMethodOptions options;
    if (is_named) options.sizes = {60};
    StandardMethod method(cache, options);
    const auto learner = find_deterministic_learner("lsharp").make(cache);
    const LearnResult result = run_learner(*learner, method);
    EXPECT_EQ(find_difference(result.model, machine), std::nullopt);
    EXPECT_LE(result.equivalence_queries, is_named ? 3U : 12U);
  }
}

TEST(ShortenCounterexample, KeepsWhatItNeeds) {
  const Mealy machine = buffer(5);
  const Mealy hypothesis = buffer(3);
  MealyOracle oracle(machine);
  Word longer;
  for (int i = 0; i < 40; ++i) longer.insert(longer.end(), {0, 1});
  longer.insert(longer.end(), 4, 0);  // the hypothesis takes it for full now
  const Word shorter = shorten_counterexample(oracle, hypothesis, longer, 1000, {});
  EXPECT_EQ(shorter, Word(4, 0));
  // Without queries it stays.
  EXPECT_EQ(shorten_counterexample(oracle, hypothesis, longer, 0, {}), longer);
}

// The first difference is at the end of what is given back.
TEST(ShortenCounterexample, OfRandomWordsIsACounterexample) {
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const Mealy machine = hiding_mealy(Hiding::nothing, 12, 4, random);
    Mealy hypothesis = machine;
    hypothesis.set_transition(static_cast<StateId>(random.below(machine.size())), 0,
                              static_cast<Symbol>(random.below(machine.outputs().size())),
                              static_cast<StateId>(random.below(machine.size())));
    MealyOracle oracle(machine);
    Word word;
    for (int length = 0; length < 100; ++length)
      word.push_back(static_cast<Symbol>(random.below(4)));
    const auto difference = [&](const Word& of) -> std::size_t {
      const Word theirs = hypothesis.output_word(of), ours = machine.output_word(of);
      for (std::size_t at = 0; at < of.size(); ++at) {
        if (theirs[at] != ours[at]) return at + 1;
      }
      return 0;
    };
    const std::size_t length = difference(word);
    if (length == 0) continue;
    word.resize(length);
    const Word shorter = shorten_counterexample(oracle, hypothesis, word, 300, {});
    EXPECT_LE(shorter.size(), word.size());
    EXPECT_EQ(difference(shorter), shorter.size());
  }
}

}  // namespace
}  // namespace maide
