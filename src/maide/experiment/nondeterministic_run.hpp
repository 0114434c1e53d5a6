// A whole learning run with `nstar`, for systems that may answer the same word in several ways:
//
//   NStar, tests -> TraceSamples -> PortioningOracle -> CountingOracle -> SulOracle -> the system
//
// There is no cache: a word that is asked again is a new sample.
#pragma once

#include <string_view>

#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/experiment/experiment.hpp"

namespace maide {

struct NondeterministicResult {
  NondeterministicMealy model;  // minimal; of a run that ended before its first hypothesis, a
                                // draft; without states if nothing was answered
  // Counts, times, error, guarantee; its own model is empty. `test_method` is "nstar".
  ExperimentResult experiment;
};

// Learns the system behind `system`. Of the options those of the tests (extra_states, max_tests,
// seed), vote.confidence and max_experiments are looked at. Throws UsageError before anything is
// run: a cache file, which has room for one answer a word.
NondeterministicResult run_nondeterministic_experiment(OutputOracle& system,
                                                       const ExperimentOptions& options,
                                                       const RunControl& control = {});

}  // namespace maide
