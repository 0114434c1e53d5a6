// maide::learn_system() and learn_oracle(): a run of an experiment with its defaults.
#include "maide/learn.hpp"

#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/strength.hpp"
#include "maide/base/text.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

ExperimentOptions experiment_options(const LearnOptions& options) {
  ExperimentOptions experiment;
  experiment.algorithm = options.algorithm;
  experiment.test_method = options.tests;
  experiment.testing.seed = options.seed;
  for (const auto& [key, value] : options.test_options) {
    require_test_option(options.algorithm, options.tests, key);
    set_test_option(experiment.testing, key, value);
  }
  experiment.cache_file = options.cache_file;
  experiment.max_experiments = options.max_words;
  experiment.old_model = options.start_from;
  return experiment;
}

Learned make_learned(std::optional<Model> model, const ExperimentResult& run) {
  Learned learned;
  learned.model = std::move(model);
  if (run.error != nullptr) {
    try {
      std::rethrow_exception(run.error);
    } catch (const Error& error) {
      learned.problem = error.what();
    }
  }
  if (run.strength) {
    learned.is_weak = run.is_weak();
    learned.strength = to_string(StatedStrength{run.strength->strength, run.strength->is_weak});
  }
  learned.guarantee = run.guarantee;
  learned.words = run.experiments;
  learned.symbols = run.symbols;
  learned.equivalence_queries = run.equivalence_queries;
  return learned;
}

}  // namespace

Learned learn_system(const std::string& system, const LearnOptions& options) {
  std::vector<std::string> words = split_shell_words(system);
  if (words.empty()) throw UsageError("no system is named");
  const std::string name = words.front();
  words.erase(words.begin());
  const SystemSpec spec = parse_system_spec(name, words);
  SystemAccess access;
  access.jobs = options.jobs;
  ExperimentOptions experiment = experiment_options(options);
  const OpenedSystem opened = open_system(spec, access, options.control);
  experiment.reference = opened.reference ? &*opened.reference : nullptr;
  experiment.testing.budget = test_budget(opened.reference.has_value());
  experiment.confirm = !opened.reference;
  if (experiment.confirm) {
    experiment.sample = words_of_a_sample;
    experiment.slower = make_slower_system(spec, access, *opened.sul, {}, options.control);
  }
  LearnedModel learned = learn_model(*opened.sul, Translation::eager, experiment, options.control,
                                     read_model_kind(options.as));
  return make_learned(std::move(learned.model), learned.experiment);
}

Learned learn_oracle(OutputOracle& oracle, const LearnOptions& options) {
  ExperimentOptions experiment = experiment_options(options);
  experiment.testing.budget = test_budget(true);
  const ExperimentResult run = run_experiment(oracle, experiment, options.control);
  if (run.model.size() == 0) return make_learned(std::nullopt, run);
  return make_learned(run.model, run);
}

}  // namespace maide
