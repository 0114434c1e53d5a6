// Models that a system may have, and the words that tell: which of several models the system has,
// and whether it has the one that is suspected. Where many systems have few different models,
// telling them apart takes a few words, and verifying a model no more than its closing tests. The
// confirmation of a final model is here too, and the reading of what a run starts from: machines
// out of model files of either kind, and logs of a system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/formats/trace_log.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/oracle/statistics.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// ---- Files that a run starts from ----
//
// The machine in the file; of an interface automaton the one of `translation`. Throws what
// read_model() throws, and UsageError, with the file's name, where no machine stands for it.
Mealy read_machine(const std::filesystem::path& path, Translation translation);

// The same as ExperimentOptions::old_model of a system with these inputs. Throws UsageError, too,
// if the machine has none of them: then the file is hardly of the same system.
Mealy read_old_machine(const std::filesystem::path& path, Translation translation,
                       const Alphabet& inputs);

// Whether the machine has one of these inputs: nothing else of it is of use for such a system.
bool shares_inputs(const Mealy& machine, const Alphabet& inputs);

// The inputs of a system, in their order.
Alphabet input_alphabet(const SulInfo& system);

// The log of a system in a file: lines of JSON (formats/trace_log.hpp), or the cache of a learning
// run (learn/cache/cache_file.hpp), which its first bytes tell. Throws UsageError if the file
// cannot be read, ParseError for its text, Interrupted.
TraceLog read_traces(const std::filesystem::path& path, const RunControl& control = {});

// ---- Confirmation ----
//
// A model is confirmed by looking again with longer waits. If a wait was too short to see
// something, or took a pause for the end of a step, that shows as a difference. The system is
// opened a second time for that.
struct ConfirmationSettings {
  VoteOptions vote;
  std::uint64_t seed = 0;
  std::uint64_t most_symbols = 20;  // given to the slower system, votes not included
};

// Plays a sample of words on the slower system, and returns how many agree with the model. One
// that differs is asked again, fresh, on the system that the model was learned from: if that
// answers otherwise now, the cache corrects itself (throws CacheCorrected). If it stands by its
// answer, and the slower system by its own, waits are too short: throws Error (inconclusive) that
// says so. What the slower system is asked is added to `counts`. Throws what the systems throw.
std::uint64_t confirm_model(const Mealy& model, const SlowerSystem& slower, Cache& cache,
                            const ConfirmationSettings& settings, QueryCounts& counts,
                            const RunControl& control);

// ---- Known models ----
struct KnownModel {
  std::string name;
  Mealy machine;  // over the system's inputs, minimal, in breadth-first order
};

// The deterministic models in the folder's files that have all of these inputs, by name; of those
// that behave alike the first. `note` hears a line about each file that is left out. Throws
// UsageError if the folder cannot be read, Interrupted.
std::vector<KnownModel> read_known_models(const std::filesystem::path& folder,
                                          Translation translation, const Alphabet& inputs,
                                          const std::function<void(const std::string&)>& note,
                                          const RunControl& control = {});

// The one model that `oracle` has not contradicted.
struct SingledOut {
  std::size_t model = 0;    // of those given; of none if all were contradicted: the last that was
  bool is_possible = true;  // it was not contradicted
  std::uint64_t words = 0;  // asked
};

// Plays an adaptive distinguishing experiment of the models, word by word. Each word rules out at
// least one model. In the worst case it leaves as few of them as any shortest word that tells two
// apart. There must be a model, and no two that behave alike.
SingledOut single_out(const std::vector<KnownModel>& models, OutputOracle& oracle,
                      const RunControl& control = {});

// The tests that hybrid ADS begins with, by length of what they reach, without those that are
// prefixes of others. No other machine of as many states passes them all. None if `old_model` lacks
// one of `inputs`. For LSharp's first words: the tests that follow ask them again, from the cache.
std::vector<Word> verifying_words(const Mealy& old_model, const Alphabet& inputs,
                                  std::uint64_t seed);

}  // namespace maide
