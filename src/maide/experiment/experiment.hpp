// A whole learning run, wired up:
//
//   learner, teacher -> Cache -> PortioningOracle -> CountingOracle -> SulOracle -> the system
//
// Where outputs are known to end the session, an ErrorAwareOracle stands before the cache.
//
// A word that the system answers in two ways is asked again until a majority decides
// (learn/oracle/vote.hpp). If an answer that learner or teacher have seen was wrong, both start
// again on the corrected cache, which costs no word that is known.
//
// A run always comes back with what was learned. One that is interrupted, or whose system fails,
// returns its last hypothesis and the error that ended it.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/run_control.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/oracle/statistics.hpp"
#include "maide/learn/oracle/vote.hpp"
#include "maide/sul/ia_translator.hpp"

namespace maide {

inline constexpr std::size_t words_of_a_sample = 5;  // ExperimentOptions::sample, for real systems

struct ExperimentOptions {
  std::string algorithm;              // a name of learners(); empty: the default
  std::string test_method;            // as TestChain reads it; empty: the default
  TestMethodOptions testing;          // seed, extra states, ...
  const Mealy* reference = nullptr;   // the system as a machine, for the perfect oracle
  std::filesystem::path cache_file;   // empty: the cache is in memory only
  Fingerprint fingerprint;            // whose words the cache file holds, besides the inputs
  std::uint64_t max_experiments = 0;  // words run on the system; 0: no limit
  VoteOptions vote;                   // how contradictions are decided
  std::optional<Mealy> old_model;     // of an earlier version of the system; need not be right
  // If there is none: models of which the system may have one. The one that it seems to have is the
  // old model.
  std::vector<KnownModel> known_models;
  // A log of the system. The system is asked about each word on which a hypothesis and the log
  // differ. An algorithm that can start from an old model starts from what the log alone gives, if
  // there is no better one.
  const TraceLog* traces = nullptr;
  std::vector<Word> known_words;  // each hypothesis is tested with these first
  // Names of outputs that end the session, '*' for any characters (learn/oracle/error_outputs.hpp).
  std::vector<std::string> error_outputs;
  bool has_refusals = false;  // Cache::Refusals::change_nothing
  bool confirm = false;       // ask each counterexample again before it is believed
  // Words that are asked again where a kept cache answers everything: it may be another system's by
  // now. Where two of them are answered otherwise the run ends with an Error that says so.
  std::size_t sample = 0;
  std::optional<SlowerSystem> slower;  // confirms the final model, where given
  // Told of each word in the cache file and its answer, before anything is asked.
  std::function<void(const Word& inputs, const std::vector<std::string>& outputs)> on_cached_word;
  HypothesisObserver on_hypothesis;  // called with each hypothesis before it is tested
};

// What the tests of a run established, and whether that is enough.
struct TestedStrength {
  // Of the model, by the last equivalence query, as far as that came.
  Strength strength;
  StrengthDemand standard;   // what a model of this size must reach not to be weak
  StrengthDemand demand;     // the same, with what TestMethodOptions::strength names
  TestCost cost_of_missing;  // to what was demanded; nothing where it is reached or not known
  TestCost budget;           // what the tests could cost; 0: up to the method
  bool is_weak = false;      // falls short of `standard`

  // "pumped=64": where it falls short of `demand`; empty: nowhere.
  std::string shortfall() const { return describe_shortfall(strength, demand); }
};

// What became of ExperimentOptions::known_models.
struct Identification {
  std::string name;         // of the model that the system was shown to have; empty: it is none
  std::size_t known = 0;    // models
  std::uint64_t words = 0;  // that told them apart
};

struct ExperimentResult {
  // The last hypothesis; without states if the run ended before the first. `origin` says how it was
  // made: "algorithm", "tests" (the guarantee), "seed", "maide" (the version), "strength",
  // "error_outputs".
  Mealy model;
  // Why the run ended before its end: Interrupted, WrapperError, NondeterminismError, ...; null:
  // the teacher found no counterexample to the model.
  std::exception_ptr error;
  std::string algorithm, test_method;  // as used
  std::string guarantee;               // what the last equivalence query establishes, in words
  // The same in numbers; nothing for nondeterministic models, whose tests have no such numbers.
  std::optional<TestedStrength> strength;

  std::vector<Contradiction> contradictions;  // words that were answered in several ways
  std::uint64_t restarts = 0;                 // of the learner, after a correction
  // Words that ExperimentOptions::traces has wrong.
  std::vector<LogContradiction> log_contradictions;
  std::optional<Identification> identified;  // if models were known

  std::uint64_t output_queries = 0;       // asked by the learning algorithm, cached or not
  std::uint64_t equivalence_queries = 0;  // the last one, which found nothing, included
  std::uint64_t experiments = 0;          // words run on the system: learning and tests
  std::uint64_t symbols = 0;              // inputs given to the system
  std::uint64_t resets = 0;               // of the system
  std::uint64_t cache_hits = 0;           // queries of learner and tests that needed no system
  double seconds = 0;                     // of the whole run, by the clock
  double seconds_in_system = 0;           // in steps; summed over systems that work in parallel
  double seconds_in_reset = 0;            // in resets; summed likewise
  double seconds_in_reset_wait = 0;       // the part of them that a word waited for
  double seconds_in_settling = 0;         // the part of the steps that was waiting for quiescence
  double seconds_in_learner = 0;          // of `seconds`, those in which no system was asked
  Statistics statistics;                  // what reached the system, by phase
  // Every hypothesis in its turn, also those of a learner that had to begin again.
  std::vector<HypothesisCost> hypotheses;

  bool is_complete() const { return error == nullptr; }
  bool is_weak() const { return strength && strength->is_weak; }
};

// Learns the system behind `system`. Throws UsageError before anything is run: an unknown name, a
// method that cannot work here, a cache file that cannot be used. Everything that happens once the
// system is being asked is in the result.
ExperimentResult run_experiment(OutputOracle& system, const ExperimentOptions& options,
                                const RunControl& control = {});

// The same through a translator. What identify() says is added to the fingerprint; sizes and budget
// that `options.testing` leaves out are find_sizes() and test_budget(), in memory if there is a
// reference.
ExperimentResult run_experiment(IaTranslator& translator, const ExperimentOptions& options,
                                const RunControl& control = {});

// The numbers that a system's options, and its bound, name as lengths of queues: depth, size,
// queue_size, sndhwm, ... Queues longer than `size`, where it is set, are not filled while learning
// and do not count.
std::vector<std::size_t> find_sizes(const SulInfo& info);

// What the tests of a hypothesis may cost by default: less on a real system than in memory.
TestCost test_budget(bool is_in_memory);

// Throws UsageError, with the options that exist, if neither the algorithm nor a method of
// `test_method` looks at the option of test_options(). Names are those of `--algorithm` and `--eq`;
// "" is the default.
void require_test_option(const std::string& algorithm, const std::string& test_method,
                         std::string_view option);

// The system behind a translator: name, translation, options, versions, bound.
Fingerprint identify(const IaTranslator& translator);

// ---- Counts, shared by the learning runs of this layer ----

// Passes on what learner and tests report, with the counts of what has reached the system; and the
// last report again whenever those have grown.
class CountedProgress : public ProgressObserver {
 public:
  // `observer` may be null. Keeps both.
  CountedProgress(ProgressObserver* observer, const CountingOracle& counter)
      : observer_(observer), counter_(counter) {}

  void on_progress(const Progress& progress) override;
  void set_hypothesis(std::size_t states);
  void repeat();

 private:
  ProgressObserver* observer_;
  const CountingOracle& counter_;
  Progress last_;
};

// Fills in the counts and times of a run that began at `start`; but not what the learner counts,
// nor the cache.
void fill_counts(ExperimentResult& result, const Statistics& statistics,
                 std::chrono::steady_clock::time_point start);

}  // namespace maide
