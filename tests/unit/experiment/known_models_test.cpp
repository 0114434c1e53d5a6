// Runs that start from models: a right one costs the closing tests and nothing more, of several the
// right one is found in few words, and none of them changes what is learned.
#include "maide/experiment/known_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Mealy machine_of(std::uint64_t seed, std::size_t states = 20) {
  Random random(seed);
  return breadth_first(
      minimize(random_mealy({.states = states, .inputs = 4, .outputs = 3}, random)));
}

// Machines that differ in a transition or two, as versions do.
std::vector<KnownModel> versions(std::size_t count) {
  const Mealy first = machine_of(1);
  std::vector<KnownModel> models{{"v0", first}};
  for (std::uint64_t seed = 1; models.size() < count; ++seed) {
    Random random(seed);
    Mealy next = first;
    const auto state = static_cast<StateId>(random.below(next.size()));
    const auto input = static_cast<Symbol>(random.below(4));
    next.set_transition(state, input, next.output(state, input),
                        static_cast<StateId>(random.below(next.size())));
    next = breadth_first(minimize(next));
    const bool is_new = std::none_of(models.begin(), models.end(), [&](const KnownModel& model) {
      return !find_distinguishing_word(model.machine, next);
    });
    if (is_new) models.push_back({"v" + std::to_string(models.size()), next});
  }
  return models;
}

// Symbols of the tests alone, from an empty cache.
std::uint64_t closing_symbols(const Mealy& model, const std::string& method) {
  MealyOracle system(model);
  CountingOracle counter(system);
  Cache cache(counter);
  const auto tests = TestChain(method).make({cache, &cache, nullptr}, {});
  EXPECT_FALSE(tests->find_counterexample(model));
  return counter.statistics().total().symbols;
}

TEST(StartFrom, ARightModelCostsTheClosingTestsAlone) {
  for (const char* method : {"hads", "standard"}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Mealy machine = machine_of(seed, 10 + 8 * seed);
      MealyOracle system(machine);
      ExperimentOptions options;
      options.test_method = method;
      options.old_model = machine;
      const ExperimentResult result = run_experiment(system, options);
      ASSERT_TRUE(result.is_complete());
      EXPECT_FALSE(find_difference(result.model, machine));
      EXPECT_EQ(result.equivalence_queries, 1U);
      // Random tests are drawn for the states as the learner found them: some more or less.
      const double closing = static_cast<double>(closing_symbols(machine, method));
      EXPECT_LE(static_cast<double>(result.symbols), 1.01 * closing) << method << seed;
    }
  }
}

// However wrong the model is, the machine is the system's, and the words that were for the model
// end with the first answer that is not its own.
TEST(StartFrom, AWrongModelMisleadsNobody) {
  const std::vector<KnownModel> models = versions(6);
  const Mealy stranger = machine_of(99, 35);
  for (const KnownModel& old : models) {
    for (const Mealy* machine : {&models[0].machine, &stranger}) {
      MealyOracle system(*machine);
      ExperimentOptions options;
      options.old_model = old.machine;
      const ExperimentResult result = run_experiment(system, options);
      ASSERT_TRUE(result.is_complete());
      EXPECT_FALSE(find_difference(result.model, *machine)) << old.name;
    }
  }
}

TEST(VerifyingWords, ShowEachTransitionAndAreNoPrefixesOfEachOther) {
  const Mealy machine = machine_of(3);
  std::vector<Word> words = verifying_words(machine, machine.inputs(), 1);
  std::set<std::pair<StateId, Symbol>> taken;
  for (const Word& word : words) {
    StateId state = machine.initial();
    for (const Symbol input : word) {
      taken.emplace(state, input);
      state = machine.target(state, input);
    }
  }
  EXPECT_EQ(taken.size(), machine.size() * 4);
  std::sort(words.begin(), words.end());
  for (std::size_t i = 1; i < words.size(); ++i) {
    EXPECT_FALSE(is_prefix(words[i - 1], words[i]));
  }
  Alphabet more = machine.inputs();
  more.intern("new");
  EXPECT_TRUE(verifying_words(machine, more, 1).empty());
}

TEST(KnownModels, EachIsSingledOutInFewWords) {
  const std::vector<KnownModel> models = versions(16);
  std::uint64_t words = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    MealyOracle system(models[i].machine);
    const SingledOut single = single_out(models, system);
    EXPECT_EQ(single.model, i);
    EXPECT_TRUE(single.is_possible);
    words += single.words;
  }
  EXPECT_LT(words,
            models.size() * (models.size() - 1) / 2);  // one for each other model would be more
}

TEST(KnownModels, OneIsIdentifiedAndTestedOrTheSystemIsLearned) {
  std::vector<KnownModel> models = versions(8);
  const KnownModel last = models.back();
  MealyOracle system(last.machine);
  ExperimentOptions options;
  options.known_models = models;
  const ExperimentResult found = run_experiment(system, options);
  ASSERT_TRUE(found.identified);
  EXPECT_EQ(found.identified->name, last.name);
  EXPECT_EQ(found.identified->known, 8U);
  EXPECT_EQ(found.equivalence_queries, 1U);
  // Those that tell the models apart, beside the closing tests.
  const std::uint64_t closing = closing_symbols(last.machine, "standard");
  EXPECT_LE(found.symbols, closing + closing / 50);

  options.known_models.pop_back();
  const ExperimentResult none = run_experiment(system, options);
  ASSERT_TRUE(none.is_complete());
  ASSERT_TRUE(none.identified);
  EXPECT_EQ(none.identified->name, "");
  EXPECT_FALSE(find_difference(none.model, last.machine));

  options.algorithm = "ttt";  // which has no use for an old model but its words
  options.known_models = models;
  EXPECT_EQ(run_experiment(system, options).identified->name, last.name);
}

TEST(KnownModels, AreReadFromAFolder) {
  const TempDir folder;
  const auto write = [&](const std::string& name, const Mealy& machine) {
    std::ofstream file(folder.path() / name);
    write_dot(file, machine);
  };
  const std::vector<KnownModel> models = versions(2);
  write("a.dot", models[0].machine);
  write("b.dot", models[1].machine);
  write("c.dot", models[0].machine);
  std::ofstream(folder.path() / "d.dot") << "digraph {";
  Random random(1);
  write("e.dot", random_mealy({.states = 3, .inputs = 2, .outputs = 2}, random));
  std::vector<std::string> notes;
  const auto read = read_known_models(folder.path(), Translation::eager, models[0].machine.inputs(),
                                      [&](const std::string& note) { notes.push_back(note); });
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].name, "a.dot");
  EXPECT_EQ(read[1].name, "b.dot");
  EXPECT_FALSE(find_difference(read[1].machine, models[1].machine));
  EXPECT_THAT(notes, ElementsAre(HasSubstr("behaves as a.dot does"), HasSubstr("d.dot"),
                                 HasSubstr("not all of the system's inputs")));
  EXPECT_THROW(read_known_models(folder.path() / "nowhere", Translation::eager,
                                 models[0].machine.inputs(), [](const std::string&) {}),
               UsageError);
}

}  // namespace
}  // namespace maide
