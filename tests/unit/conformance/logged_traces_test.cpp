// Logs as a source of counterexamples.
#include <gtest/gtest.h>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

TraceLog log_of(const Mealy& machine, std::size_t traces, Random& random) {
  TraceLog log{machine.inputs(), machine.outputs(), {}};
  for (std::size_t i = 0; i < traces; ++i) {
    Word word(random.between(1, 12));
    for (Symbol& input : word) input = static_cast<Symbol>(random.below(machine.inputs().size()));
    log.traces.push_back({word, machine.output_word(word)});
  }
  return log;
}

Mealy example(Random& random) {
  return minimize(random_mealy({.states = 15, .inputs = 3, .outputs = 3}, random));
}

TEST(LoggedTraces, AsksOnlyWhereHypothesisAndLogDiffer) {
  Random random(1);
  const Mealy machine = example(random);
  MealyOracle system(machine);
  CountingOracle counter(system);
  LoggedTraces traces(counter, log_of(machine, 2000, random));
  EXPECT_FALSE(traces.find_counterexample(machine).has_value());
  EXPECT_EQ(counter.statistics().total().queries, 0U);
  const Mealy other = mutate(machine, 1, random);
  ASSERT_TRUE(find_difference(machine, other).has_value());
  const auto word = traces.find_counterexample(other);
  ASSERT_TRUE(word.has_value());
  EXPECT_NE(machine.output_word(*word), other.output_word(*word));
  EXPECT_EQ(counter.statistics().total().queries, 1U);
  EXPECT_TRUE(traces.contradictions().empty());
  EXPECT_EQ(traces.guarantee(), "agrees with 2000 logged traces");
}

TEST(LoggedTraces, SaysWhatTheSystemHasNoInputsFor) {
  Random random(1);
  const Mealy machine = example(random);
  MealyOracle system(machine);
  TraceLog log;
  const std::vector<std::string> inputs{machine.inputs().name(0), "other"};
  log.inputs = Alphabet(std::span<const std::string>(inputs));
  log.outputs = machine.outputs();
  const Symbol output = machine.output(machine.initial(), 0);
  log.traces = {{{0, 1}, {output, output}}, {{1}, {output}}, {{0}, {output}}};
  EXPECT_EQ(LoggedTraces(system, log).guarantee(),
            "agrees with 3 logged traces, of 2 only up to an input that the system does not have");
  log.traces = {{{1}, {output}}};
  EXPECT_THROW(LoggedTraces(system, log), UsageError);
}

// The log is of another version: whatever it says, the system has the last word.
TEST(LoggedTraces, ALogOfAnotherVersionIsCorrected) {
  Random random(2);
  std::size_t wrong = 0;
  for (int i = 0; i < 20; ++i) {
    const Mealy machine = example(random);
    const TraceLog log = log_of(mutate(machine, 1, random), 300, random);
    for (const LearnerEntry& algorithm : deterministic_learners()) {
      MealyOracle system(machine);
      auto traces = std::make_unique<LoggedTraces>(system, log);
      const LoggedTraces& kept = *traces;
      std::vector<std::unique_ptr<EquivalenceOracle>> links;
      links.push_back(std::move(traces));
      links.push_back(std::make_unique<PerfectOracle>(machine));
      ChainOracle teacher(std::move(links));
      const auto learner = algorithm.make(system);
      const LearnResult result = run_learner(*learner, teacher);
      EXPECT_FALSE(find_difference(result.model, machine).has_value());
      wrong += kept.contradictions().size();
      for (const LogContradiction& one : kept.contradictions()) EXPECT_NE(one.logged, one.answered);
    }
  }
  EXPECT_GT(wrong, 0U);
}

TEST(LoggedTraces, GivesUpTheLogOfAnotherSystem) {
  Random random(3);
  const Mealy machine = random_mealy({.states = 200, .inputs = 3, .outputs = 3}, random);
  MealyOracle system(machine);
  LoggedTraces traces(system, log_of(mutate(machine, 100, random), 5000, random));
  EXPECT_FALSE(traces.find_counterexample(machine).has_value());
  EXPECT_EQ(traces.contradictions().size(), LoggedTraces::most_contradictions);
  EXPECT_FALSE(traces.find_counterexample(machine).has_value());
  EXPECT_EQ(traces.guarantee(), "the log was given up");
}

TEST(LoggedTraces, CutsTracesAtInputsThatTheSystemDoesNotHave) {
  Mealy machine({"a"}, {"x"}, 1);
  machine.set_transition(0, 0, 0, 0);
  MealyOracle system(machine);
  const TraceLog log{{"b", "a"}, {"y", "x"}, {{{1, 0, 1}, {1, 0, 0}}, {{1, 1}, {1, 0}}}};
  LoggedTraces traces(system, log);
  EXPECT_EQ(traces.cut_traces(), 1U);
  EXPECT_FALSE(traces.find_counterexample(machine).has_value());
  ASSERT_EQ(traces.contradictions().size(), 1U);
  EXPECT_EQ(traces.contradictions()[0].word, "a a");
  EXPECT_EQ(traces.contradictions()[0].logged, "y");
  EXPECT_EQ(traces.contradictions()[0].answered, "x");
}

TEST(LoggedTraces, RefusesALogThatContradictsItself) {
  Mealy machine({"a"}, {"x"}, 1);
  machine.set_transition(0, 0, 0, 0);
  MealyOracle system(machine);
  const TraceLog log{{"a"}, {"x", "y"}, {{{0}, {0}}, {{0}, {1}}}};
  EXPECT_THROW(LoggedTraces(system, log), UsageError);
}

}  // namespace
}  // namespace maide
