// The same seed gives the same run, bit for bit, whatever the number of systems that are asked at
// once: model, counts, and the cache with its numbering of outputs.
#include <gtest/gtest.h>

#include <sstream>

#include "maide/automata/random_automata.hpp"
#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/learner.hpp"
#include "maide/sul/simulated_sul.hpp"
#include "maide/sul/sul_pool.hpp"

namespace maide {
namespace {

// All that can be seen of a run but its durations.
struct Outcome {
  std::string model;
  std::vector<std::uint64_t> counts;
  std::vector<std::string> outputs;            // of the cache, as it numbers them
  std::vector<std::pair<Word, Word>> answers;  // in the cache, in their order
  bool operator==(const Outcome&) const = default;
};

template <typename Automaton>
std::unique_ptr<Sul> make_system(const Automaton& automaton, std::size_t jobs) {
  if (jobs == 1) return std::make_unique<SimulatedSul>(automaton, "sim");
  std::vector<SulPool::Member> members;
  for (std::size_t job = 0; job < jobs; ++job) {
    members.push_back({"sim", std::make_unique<SimulatedSul>(automaton, "sim")});
  }
  return std::make_unique<SulPool>(std::move(members));
}

Outcome learn(Sul& sul, ExperimentOptions options) {
  const TempDir folder;
  options.cache_file = folder.path() / "answers.cache";
  IaTranslator translator(sul, Translation::eager);
  const ExperimentResult result = run_experiment(translator, options);
  EXPECT_TRUE(result.is_complete());
  Outcome outcome;
  std::ostringstream text;
  write_dot(text, result.model);
  outcome.model = text.str();
  outcome.counts = {result.output_queries, result.equivalence_queries,
                    result.experiments,    result.symbols,
                    result.resets,         result.cache_hits};
  for (const LearnPhase phase :
       {LearnPhase::learning, LearnPhase::refinement, LearnPhase::testing}) {
    outcome.counts.push_back(result.statistics.at(phase).symbols);
  }
  Fingerprint fingerprint = options.fingerprint;
  fingerprint.merge(identify(translator));
  CacheFile file(options.cache_file, translator.inputs(), fingerprint);
  outcome.outputs = file.outputs().names();
  file.for_each([&](const Word& inputs, const Word& outputs) {
    outcome.answers.emplace_back(inputs, outputs);
  });
  EXPECT_LE(outcome.answers.size(), result.experiments);
  return outcome;
}

template <typename Automaton>
void expect_the_same_run(const Automaton& automaton) {
  for (const LearnerEntry& learner : deterministic_learners()) {
    for (const char* method : {"standard", "w", "random-words", "random-walk"}) {
      ExperimentOptions options;
      options.algorithm = learner.name;
      options.test_method = method;
      options.testing.seed = 7;
      options.testing.max_tests = 300;
      const auto alone = make_system(automaton, 1);
      const Outcome expected = learn(*alone, options);
      for (const std::size_t jobs : {2U, 4U, 8U}) {
        const auto pool = make_system(automaton, jobs);
        EXPECT_TRUE(learn(*pool, options) == expected)
            << learner.name << ", " << method << ", " << jobs << " jobs";
      }
    }
  }
}

TEST(Pool, APortIsLearnedInTheSameRunWhateverTheNumberOfSystems) {
  expect_the_same_run(std::get<InterfaceAutomaton>(
      read_model(MAIDE_SOURCE_DIR "/tests/models/strict-3-tryread.dot")));
}

TEST(Pool, AMachineIsLearnedInTheSameRunWhateverTheNumberOfSystems) {
  Random random(5);
  expect_the_same_run(random_mealy({.states = 12, .inputs = 3, .outputs = 6}, random));
}

}  // namespace
}  // namespace maide
