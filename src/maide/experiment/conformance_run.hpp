// Tests whether a running system does what a model says: the model is the hypothesis of one
// equivalence query (conformance/method). The stack:
//
//   tests -> Judge -> Cache -> PortioningOracle -> CountingOracle -> SulOracle -> the system
//
// The `Judge` follows each word on the model. It leaves out inputs that the model has as never
// tried, so nothing is said there. It counts what was covered. Behind a transition that is known to
// fail it answers as the model does, so the same query goes on and finds what else differs.
//
// A difference is believed once the system has shown it again, in words asked afresh, and with
// longer waits where the system has waits. The word that is reported is the shortest that shorter
// ways into its states and left-out pieces lead to; there may be a shorter one still.
//
// Invariant: a word is reported only if the system was asked that very word.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/run_control.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/formats/trace_log.hpp"
#include "maide/learn/oracle/vote.hpp"
#include "maide/sul/ia_translator.hpp"

namespace maide {

struct ConformanceOptions {
  std::string test_method;                 // as TestChain reads it; empty: the default
  TestMethodOptions testing;               // seed, extra states, ...
  std::optional<std::uint64_t> max_tests;  // then the run ends, unfinished
  const Mealy* reference = nullptr;        // the system as a machine, for the perfect oracle
  const TraceLog* words = nullptr;     // asked before all else; what was answered is not looked at
  std::filesystem::path cache_file;    // empty: the cache is in memory only
  VoteOptions vote;                    // how contradictions are decided
  bool confirm = true;                 // ask again what differs
  std::optional<SlowerSystem> slower;  // the same with longer waits
  std::size_t most_failures = 10;      // then the run ends
};

// A transition on which the system gives another output than the model.
struct ConformanceFailure {
  StateId state = 0;
  Symbol input = 0;
  Word word;                       // ends with the transition
  std::string expected, observed;  // outputs of the word's last input: the model's, the system's
};

// A word that differed, and did not when the system waited longer.
struct UnsteadyWord {
  Word word;
  std::string expected, observed;
};

struct Coverage {
  std::uint64_t covered = 0, total = 0;
};

struct ConformanceResult {
  Mealy model;               // minimal, in breadth-first order; states and inputs below are its own
  std::vector<Word> access;  // a shortest word to each state
  std::vector<bool> never_tried;  // by state and input (state-major): not judged
  std::vector<bool> covered;      // likewise: passed by a word that agreed up to there and on it
  std::vector<ConformanceFailure> failures;  // shortest first
  std::vector<UnsteadyWord> unsteady;
  Coverage states, transitions, pairs;  // pairs: two transitions in a row
  // Of the system, that the model does not have. They are not tested.
  std::vector<std::string> other_inputs;
  std::string guarantee;      // what the tests establish, in words
  std::string shortfall;      // where that is less than what a learned model must reach; or empty
  std::uint64_t words = 0;    // run on the system
  std::uint64_t symbols = 0;  // inputs given to it
  double seconds = 0;
  // Why the run ended early: Interrupted, WrapperError, NondeterminismError; null: it did not.
  std::exception_ptr error;

  bool conforms() const { return failures.empty() && error == nullptr && unsteady.empty(); }
};

// Tests the system behind `translator`. Throws UsageError before anything is asked: an unknown
// method, inputs of the model that the system lacks, a cache of another system. Everything later is
// in the result. `model` must be complete and is minimised.
ConformanceResult test_conformance(IaTranslator& translator, const Mealy& model,
                                   const ConformanceOptions& options,
                                   const RunControl& control = {});

}  // namespace maide
