#include "maide/workflow/nondeterministic_run.hpp"

#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/version.hpp"
#include "maide/conformance/method/nondeterministic_tests.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/passive/trace_samples.hpp"
#include "maide/learn/table/nstar.hpp"
#include "maide/workflow/experiment.hpp"
#include "maide/workflow/pacing.hpp"

namespace maide {
namespace {

NondeterministicTestOptions test_options(const TestMethodOptions& given) {
  NondeterministicTestOptions options;
  if (given.extra_states) options.extra_states = *given.extra_states;
  if (given.max_tests) options.max_tests = *given.max_tests;
  options.seed = given.seed;
  return options;
}

// Learns until no test refutes the hypothesis.
void learn(NStar& learner, TraceSamples& samples, CountingOracle& counter,
           CountedProgress& progress, const ExperimentOptions& options, const RunControl& control,
           ExperimentResult& result) {
  NondeterministicTests tests(learner, samples, test_options(options.testing));
  learner.start(control);
  while (true) {
    ++result.equivalence_queries;
    progress.set_hypothesis(learner.hypothesis().size());
    result.hypotheses.push_back({learner.hypothesis().size(), counter.statistics()});
    counter.set_phase(LearnPhase::testing);
    const bool is_refuted = tests.is_refuted(control);
    result.guarantee = tests.guarantee();
    if (!is_refuted) return;
    counter.set_phase(LearnPhase::refinement);
    learner.refine(control);
  }
}

}  // namespace

NondeterministicResult run_nondeterministic_experiment(OutputOracle& system,
                                                       const ExperimentOptions& options,
                                                       const RunControl& control) {
  if (!options.cache_file.empty()) {
    throw UsageError("a cache keeps one answer a word: it cannot be used with nstar");
  }
  const auto start = std::chrono::steady_clock::now();
  CountingOracle counter(system);
  CountedProgress progress(control.progress, counter);
  PaceOptions pace;
  if (options.max_experiments != 0) pace.max_queries = options.max_experiments;
  pace.after_portion = [&progress] { progress.repeat(); };
  PortioningOracle portioned(counter, pace);
  TraceSamples samples(portioned, {.confidence = options.vote.confidence});
  NStar learner(samples);

  NondeterministicResult result;
  ExperimentResult& run = result.experiment;
  run.algorithm = run.test_method = "nstar";
  run.guarantee = "not tested";
  RunControl counted = control;
  counted.progress = &progress;
  try {
    learn(learner, samples, counter, progress, options, counted, run);
  } catch (...) {
    run.error = std::current_exception();
    const bool has_hypothesis = learner.hypothesis().size() > 0;
    if (!has_hypothesis && samples.size() > 1) learner.make_draft();
  }
  result.model = minimize(learner.hypothesis());
  result.model.origin["algorithm"] = run.algorithm;
  result.model.origin["tests"] = run.guarantee;
  result.model.origin["seed"] = std::to_string(options.testing.seed);
  result.model.origin["maide"] = version();
  const Statistics& statistics = counter.statistics();
  run.output_queries =
      statistics.at(LearnPhase::learning).queries + statistics.at(LearnPhase::refinement).queries;
  fill_counts(run, statistics, start);
  return result;
}

}  // namespace maide
