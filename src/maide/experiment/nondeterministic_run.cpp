#include "maide/experiment/nondeterministic_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/base/version.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/passive/trace_samples.hpp"
#include "maide/learn/table/nstar.hpp"

namespace maide {
namespace {

// ---- Tests ----
//
// Tests of a nondeterministic hypothesis. Some words are run until everything that they may lead to
// was seen (trace_samples.hpp); random words are run once. Two things refute the hypothesis: an
// output that it does not allow, and an output that it allows and that was not seen where the
// samples are complete.

struct NondeterministicTestOptions {
  std::size_t extra_states = 1;   // all words of one input more follow each transition
  std::uint64_t max_tests = 500;  // words run to the end; a sample, if there are more
  std::uint64_t random_words = 500;
  std::uint64_t seed = 0;
};

class NondeterministicTests {
 public:
  // Keeps both references.
  NondeterministicTests(const NStar& learner, TraceSamples& samples,
                        const NondeterministicTestOptions& options)
      : learner_(learner), samples_(samples), options_(options), random_(options.seed) {}

  // True if the learner's hypothesis is refuted by the samples, after the tests. Throws what the
  // system throws.
  bool is_refuted(const RunControl& control = {});

  // What the last test that refuted nothing establishes.
  std::string guarantee() const { return guarantee_; }

 private:
  std::vector<Word> covering_words(const RunControl& control);
  std::vector<Word> random_words();

  const NStar& learner_;
  TraceSamples& samples_;
  NondeterministicTestOptions options_;
  Random random_;
  std::string guarantee_ = "not tested";
};

constexpr std::size_t portion = 50;  // words between two looks at the samples

// The transition cover, each word followed by all words of extra_states + 1 inputs; or so many of
// these, drawn at random, as may be run.
std::vector<Word> NondeterministicTests::covering_words(const RunControl& control) {
  const auto inputs = static_cast<Symbol>(samples_.inputs().size());
  std::vector<Word> words = learner_.transition_cover();
  for (std::size_t step = 0; step <= options_.extra_states; ++step) {
    control.check("the equivalence test");
    random_.shuffle(words);
    if (words.size() > options_.max_tests) words.resize(options_.max_tests);
    std::vector<Word> longer;
    for (const Word& word : words) {
      if (longer.size() % 4096 < inputs) control.check("the equivalence test");
      for (Symbol input = 0; input < inputs; ++input) {
        longer.push_back(word);
        longer.back().push_back(input);
      }
    }
    words = std::move(longer);
  }
  random_.shuffle(words);
  if (words.size() > options_.max_tests) words.resize(options_.max_tests);
  return words;
}

std::vector<Word> NondeterministicTests::random_words() {
  std::vector<Word> words(options_.random_words);
  for (Word& word : words) {
    word.resize(random_.between(1, 2 * learner_.hypothesis().size() + 5));
    for (Symbol& input : word) input = static_cast<Symbol>(random_.below(samples_.inputs().size()));
  }
  return words;
}

bool NondeterministicTests::is_refuted(const RunControl& control) {
  guarantee_ = "not tested to the end";
  const std::vector<Word> random = random_words();
  samples_.run(random, control);
  if (learner_.find_mismatch()) return true;
  const std::vector<Word> covering = covering_words(control);
  for (std::size_t start = 0; start < covering.size(); start += portion) {
    const auto first = covering.begin() + static_cast<std::ptrdiff_t>(start);
    const std::size_t size = std::min(portion, covering.size() - start);
    samples_.sample({first, first + static_cast<std::ptrdiff_t>(size)}, control);
    if (learner_.find_mismatch()) return true;
  }
  guarantee_ = fmt::format(
      "not refuted by {} words of the transition cover and {} inputs more, each place asked {} "
      "times, and {} random words",
      covering.size(), options_.extra_states + 1, samples_.needed(), random.size());
  return false;
}

// ---- The run ----

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
