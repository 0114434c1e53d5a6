// Measures learners x models: the words that each learner asks, those that reach the system through
// the cache, and the processor time. Models are known machines, so that the result can be compared
// with them. Each run is wired as `maide learn` wires it:
//
//   learner, teacher -> CountingOracle (asked) -> Cache -> CountingOracle (sent) -> the machine
//
// So one run gives the figures of both conventions: without a cache, as papers count, and with one.
// The counts depend on model, learner, method and seed alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/statistics.hpp"

namespace maide {

struct BenchModel {
  std::string name;  // the file's; without its extension where that tells it from the others
  Mealy machine;     // minimal
  // A model of an earlier version, which learners start from.
  std::optional<Mealy> old_version = std::nullopt;
};

struct BenchFolder {
  std::vector<BenchModel> models;       // by name
  std::vector<std::string> unreadable;  // what is wrong with the other model files, a line each
};

// All model files of the folder, not of those in it. An interface automaton counts as its Mealy
// machine (eager); one without inputs counts as unreadable. Throws UsageError if there is no such
// folder, it cannot be read, or no model file is in it.
BenchFolder read_bench_folder(const std::filesystem::path& folder);

// Gives each model the one of the same name in another such folder, if it is there. One that cannot
// be started from, for it shares no input, counts as unreadable. Throws UsageError as above, and if
// no name is in both.
void add_old_versions(BenchFolder& folder, const std::filesystem::path& old_versions);

struct BenchOptions {
  std::vector<std::string> algorithms;  // names of learners(), each counts once; empty: all
  std::string test_method = "perfect";  // as TestChain reads it
  TestMethodOptions testing;            // seed, extra states, ...
  bool use_cache = true;
  // Limits of one run; one that reaches a limit is reported as unfinished.
  std::optional<double> seconds;      // by the clock
  std::uint64_t max_experiments = 0;  // words that reach the system; 0: no limit
  std::size_t jobs = 0;               // runs at once; 0: one for each processor
};

// The learners that are measured, in their order. Throws UsageError for a name that is none.
std::vector<const LearnerEntry*> bench_learners(const BenchOptions& options);

enum class BenchOutcome : std::uint8_t {
  right,       // equivalent to the model, and minimal
  wrong,       // the teacher found no counterexample, but there is one
  unfinished,  // a limit, or an error
};
std::string_view to_string(BenchOutcome outcome);  // "right", "wrong", "unfinished"

struct BenchRun {
  std::size_t model = 0;       // its place among the models
  std::string_view algorithm;  // of learners()
  BenchOutcome outcome = BenchOutcome::unfinished;
  std::string error;       // why it is unfinished
  std::size_t states = 0;  // of what was learned, the last hypothesis
  std::uint64_t equivalence_queries = 0;
  Statistics asked;        // by learner and tests, cached or not
  Statistics sent;         // of that, what reached the system
  double cpu_seconds = 0;  // of the thread: learner, tests, cache and simulation
  std::uint64_t cache_edges = 0, cache_bytes = 0;
};

// Every algorithm on every model, several at once. `on_run` is called in the order of models, then
// of algorithms, as soon as that order allows, one call at a time. Throws UsageError before
// anything is run. If `control` says stop, running ones are dropped, `on_run` gets what was
// measured behind the gaps, too, and the result is false.
bool run_bench(const std::vector<BenchModel>& models, const BenchOptions& options,
               const std::function<void(const BenchRun&)>& on_run, const RunControl& control = {});

}  // namespace maide
