#include "maide/workflow/experiment.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "maide/learn/cache.hpp"
#include "maide/learn/confirming_teacher.hpp"
#include "maide/learn/counting_oracle.hpp"
#include "maide/learn/learners.hpp"
#include "maide/learn/sul_oracle.hpp"
#include "maide/workflow/paced_oracle.hpp"

namespace maide {
namespace {

// Passes on what learner and tests report, with the counts of what has reached the system; and the
// last report again whenever those have grown.
class CountedProgress : public ProgressObserver {
 public:
  CountedProgress(ProgressObserver* observer, const CountingOracle& counter)
      : observer_(observer), counter_(counter) {}

  void on_progress(const Progress& progress) override {
    last_ = progress;
    repeat();
  }
  void set_hypothesis(std::size_t states) {
    last_ = {};
    last_.states = states;
  }
  void repeat() {
    if (observer_ == nullptr) return;
    if (last_.total == 0) last_.phase = to_string(counter_.phase());
    const QueryCounts counts = counter_.statistics().total();
    last_.words = counts.queries;
    last_.symbols = counts.symbols;
    observer_->on_progress(last_);
  }

 private:
  ProgressObserver* observer_;
  const CountingOracle& counter_;
  Progress last_;
};

double to_seconds(std::chrono::microseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

void fill_counts(ExperimentResult& result, const CountingOracle& counter, const Cache& cache,
                 std::chrono::steady_clock::time_point start) {
  const QueryCounts total = counter.statistics().total();
  result.experiments = total.queries;
  result.symbols = total.symbols;
  result.resets = total.resets;
  result.cache_hits = cache.hits();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.seconds_in_system = to_seconds(total.in_system);
  result.seconds_in_reset = to_seconds(total.in_reset);
  result.seconds_in_reset_wait = to_seconds(total.in_reset_wait);
  result.seconds_in_settling = to_seconds(total.in_settling);
  result.seconds_in_learner = std::max(0.0, result.seconds - to_seconds(total.asking));
  result.statistics = counter.statistics();
}

}  // namespace

ExperimentResult run_experiment(OutputOracle& system, const ExperimentOptions& options,
                                const RunControl& control) {
  const auto start = std::chrono::steady_clock::now();
  const LearnerEntry& algorithm =
      options.algorithm.empty() ? learners().front() : find_learner(options.algorithm);
  const TestMethodEntry& method =
      options.test_method.empty() ? test_methods().front() : find_test_method(options.test_method);
  CountingOracle counter(system);
  CountedProgress progress(control.progress, counter);
  PaceOptions pace;
  if (options.max_experiments != 0) pace.max_queries = options.max_experiments;
  pace.after_portion = [&progress] { progress.repeat(); };
  PacedOracle paced(counter, pace);
  std::optional<CacheFile> file;
  if (!options.cache_file.empty()) {
    file.emplace(options.cache_file, system.inputs(), options.fingerprint);
  }
  Cache cache = file ? Cache(paced, *file) : Cache(paced);
  LearnPhase phase = counter.phase();
  cache.hold_votes(options.vote, [&](bool begins) {
    if (begins) phase = counter.phase();
    counter.set_phase(begins ? LearnPhase::confirmation : phase);
  });

  ExperimentResult result;
  result.algorithm = algorithm.name;
  result.test_method = method.name;
  RunControl counted = control;
  counted.progress = &progress;
  const auto on_hypothesis = [&](const Mealy& hypothesis, std::uint64_t) {
    ++result.equivalence_queries;
    progress.set_hypothesis(hypothesis.size());
    if (options.on_hypothesis) options.on_hypothesis(hypothesis, result.equivalence_queries);
  };
  // True if the run is over, false if it must start again on a corrected cache.
  const auto run_once = [&] {
    const auto tests = method.make({cache, &cache, options.reference}, options.testing);
    ConfirmingTeacher confirming(*tests, cache);
    PhasedTeacher teacher(options.confirm ? confirming : *tests, counter);
    const auto learner = algorithm.make(cache);
    counter.set_phase(LearnPhase::learning);
    bool is_over = true;
    try {
      run_learner(*learner, teacher, counted, on_hypothesis);
    } catch (const CacheCorrected&) {
      is_over = false;
      ++result.restarts;
    } catch (...) {
      result.error = std::current_exception();
    }
    result.output_queries += learner->output_queries();
    // A run that ends before its first hypothesis leaves the one before.
    if (learner->hypothesis().size() > 0) result.model = learner->hypothesis();
    result.guarantee = teacher.guarantee();
    return is_over;
  };
  while (!run_once()) {
  }
  result.contradictions = cache.contradictions();
  result.model.origin["algorithm"] = result.algorithm;
  result.model.origin["tests"] = result.guarantee;
  result.model.origin["seed"] = std::to_string(options.testing.seed);
  fill_counts(result, counter, cache, start);
  return result;
}

ExperimentResult run_experiment(IaTranslator& translator, const ExperimentOptions& options,
                                const RunControl& control) {
  ExperimentOptions completed = options;
  completed.fingerprint.merge(identify(translator));
  SulOracle system(translator);
  return run_experiment(system, completed, control);
}

Fingerprint identify(const IaTranslator& translator) {
  const SulInfo& info = translator.info();
  Fingerprint result(info.options);
  result["the system"] = info.name;
  result["the translation"] = to_string(translator.translation());
  if (!info.bound.empty()) result["the bound"] = info.bound;
  for (const auto& [what, version] : info.versions) result["the version of " + what] = version;
  return result;
}

}  // namespace maide
