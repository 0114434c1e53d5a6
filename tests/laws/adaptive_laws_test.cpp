// Laws of learning from a model of an earlier version: whatever that model is, the result is the
// minimal machine of the system; where it is right or nearly so, it costs less than learning anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <memory>

#include "learner_names.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/lsharp/old_model.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/sul/ia_translation.hpp"
#include "small_machines.hpp"

namespace maide {
namespace {

struct Cost {
  std::uint64_t symbols_and_resets = 0;
  std::uint64_t equivalence_queries = 0;
  std::uint64_t output_queries = 0;
};

// Learns `reference`, from `old_model` unless that is null; expects the minimal machine.
Cost learn_from(const LearnerEntry& algorithm, const Mealy& reference, const Mealy* old_model) {
  MealyOracle system(reference);
  CountingOracle counter(system);
  Cache cache(counter);
  std::vector<std::unique_ptr<EquivalenceOracle>> links;
  if (auto words = first_words(algorithm, old_model, reference.inputs()); !words.empty()) {
    links.push_back(std::make_unique<KnownWords>(cache, std::move(words)));
  }
  links.push_back(std::make_unique<PerfectOracle>(reference));
  ChainOracle teacher(std::move(links));
  const auto learner = make_learner(algorithm, cache, old_model);
  const LearnResult result = run_learner(*learner, teacher);
  EXPECT_FALSE(find_difference(reference, result.model).has_value());
  EXPECT_EQ(result.model.size(), minimize(reference).size());
  const QueryCounts counts = counter.statistics().total();
  return {counts.symbols + counts.resets, result.equivalence_queries, learner->output_queries()};
}

class AdaptiveLaws : public testing::TestWithParam<std::string> {
 protected:
  const LearnerEntry& algorithm() const { return find_deterministic_learner(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(All, AdaptiveLaws, testing::ValuesIn(test::learner_names()),
                         [](const auto& entry) { return test::as_test_name(entry.param); });

TEST_P(AdaptiveLaws, LearnsSmallMachinesFromAnyOldModel) {
  Random random(1);
  for (int i = 0; i < 4000; ++i) {
    const std::uint64_t states = random.between(1, 3), old_states = random.between(1, 3);
    const Mealy reference = small_machine(states, random.below(count_small_machines(states)));
    const Mealy old = small_machine(old_states, random.below(count_small_machines(old_states)));
    learn_from(algorithm(), reference, &old);
    if (HasFailure()) FAIL() << "pair " << i;
  }
}

TEST_P(AdaptiveLaws, LearnsRandomMachinesFromMutantsAndFromStrangers) {
  Random random(2);
  for (int i = 0; i < 60; ++i) {
    const RandomMealyOptions options{.states = random.between(1, 40),
                                     .inputs = random.between(1, 5),
                                     .outputs = random.between(1, 4)};
    const Mealy old = random_mealy(options, random);
    learn_from(algorithm(), mutate(old, random.between(0, 8), random), &old);
    // Some of the inputs and outputs are the same.
    const Mealy stranger = random_mealy({.states = 15, .inputs = 3, .outputs = 3}, random);
    learn_from(algorithm(), stranger, &old);
    if (HasFailure()) FAIL() << "machine " << i;
  }
}

TEST_P(AdaptiveLaws, AnOldModelWithOtherInputsChangesNothing) {
  Random random(3);
  const Mealy reference = random_mealy({.states = 20, .inputs = 3, .outputs = 2}, random);
  Mealy stranger({"x", "y"}, {"1"}, 1);
  for (const Symbol input : {0, 1}) stranger.set_transition(0, input, 0, 0);
  const Cost without = learn_from(algorithm(), reference, nullptr);
  const Cost with = learn_from(algorithm(), reference, &stranger);
  EXPECT_EQ(with.symbols_and_resets, without.symbols_and_resets);
}

class LSharpAdaptive : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, LSharpAdaptive, testing::Values("lsharp", "lsharp-sepseq"),
                         [](const auto& entry) {
                           return entry.param == "lsharp" ? "ads" : "words";
                         });

// The models of the paper's ports and random machines, all minimal.
std::vector<Mealy> example_machines() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(MAIDE_SOURCE_DIR "/tests/models")) {
    if (entry.path().extension() == ".dot") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Mealy> machines;
  for (const auto& path : paths) {
    machines.push_back(to_mealy(read_interface_automaton(path), Translation::av));
  }
  Random random(4);
  for (int i = 0; i < 10; ++i) {
    machines.push_back(minimize(random_mealy({.states = 30, .inputs = 4, .outputs = 3}, random)));
  }
  return machines;
}

TEST_P(LSharpAdaptive, NeedsOneEquivalenceQueryIfNothingChanged) {
  const LearnerEntry& algorithm = find_deterministic_learner(GetParam());
  std::uint64_t with = 0, without = 0;
  for (const Mealy& machine : example_machines()) {
    const Cost cost = learn_from(algorithm, machine, &machine);
    EXPECT_EQ(cost.equivalence_queries, 1U) << machine.size();
    with += cost.symbols_and_resets;
    without += learn_from(algorithm, machine, nullptr).symbols_and_resets;
  }
  EXPECT_LT(with, without);
}

TEST_P(LSharpAdaptive, SavesQueriesIfLittleChanged) {
  const LearnerEntry& algorithm = find_deterministic_learner(GetParam());
  Random random(5);
  Cost with, without;
  for (const Mealy& machine : example_machines()) {
    for (int i = 0; i < 5; ++i) {
      const Mealy next = minimize(mutate(machine, 1, random));
      const Cost from_old = learn_from(algorithm, next, &machine);
      const Cost anew = learn_from(algorithm, next, nullptr);
      with.symbols_and_resets += from_old.symbols_and_resets;
      with.equivalence_queries += from_old.equivalence_queries;
      without.symbols_and_resets += anew.symbols_and_resets;
      without.equivalence_queries += anew.equivalence_queries;
    }
  }
  EXPECT_LT(with.symbols_and_resets, without.symbols_and_resets);
  EXPECT_LT(with.equivalence_queries * 2, without.equivalence_queries);
}

// What the old model adds to the bound of L# is what its doubts ask: two words each, and of those
// that find no state eight more than of those that do.
TEST_P(LSharpAdaptive, AWrongOldModelCostsFewQueries) {
  const LearnerEntry& algorithm = find_deterministic_learner(GetParam());
  Random random(6);
  for (int i = 0; i < 30; ++i) {
    const Mealy reference = random_mealy({.states = 25, .inputs = 3, .outputs = 2}, random);
    const Mealy old = random_mealy({.states = 40, .inputs = 3, .outputs = 2}, random);
    const std::uint64_t states = minimize(reference).size();
    const Cost cost = learn_from(algorithm, reference, &old);
    const std::uint64_t longest = 40;  // of the perfect oracle's counterexamples
    EXPECT_LE(cost.output_queries, states * states * 3 +
                                       (states - 1) * (3 + std::bit_width(longest + states)) +
                                       2 * (8 + 2 * (states - 1)));
  }
}

}  // namespace
}  // namespace maide
