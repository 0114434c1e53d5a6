// Results of others that ours are compared with. The paper's are those of "Reverse Engineering of
// Middleware for Verification of Robot Control Architectures" (Khalili, Natale, Tacchella, SIMPAR
// 2014), with the systems of ours that correspond to them. Other tools' are what they ask to learn
// automata. The figures are in reproduce/*.yaml, which are compiled in. None was measured by this
// program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/check/engines/verdict.hpp"

namespace maide {

// A row of Table 1: a configuration of a YARP port, learned with L*M+.
struct PaperLearningRow {
  std::string configuration;  // the paper's words; "*" marks rows with a non-blocking read
  std::size_t states = 0, transitions = 0;
  std::uint64_t output_queries = 0, equivalence_queries = 0, experiments = 0;
  double thousand_seconds = 0;
};

// A row of ours beside it.
struct ReproducedRow {
  PaperLearningRow paper;
  std::map<std::string, std::string> options;  // of the system that is learned here
};

// Table 1 (top and bottom) on a system of ours: "yarp", the paper's, and "port" have a counterpart
// of every row, other middlewares of the buffered ones. Throws UsageError for other systems.
std::vector<ReproducedRow> table1_rows(const std::string& system);

// The systems that have rows.
std::vector<std::string> table1_systems();

// Figure 3: eager Mealy machines of a port whose waiting writer is interrupted, over write, read
// and interrupt. One is what one would expect, the other is what the paper found YARP to do.
// "refused": the call before has not returned.
Mealy expected_interrupt_model();
Mealy paper_interrupt_model();

// The options by which a system is learned with these inputs and outputs, and the systems of ours
// whose writer can be interrupted.
std::map<std::string, std::string> interrupt_options();
std::vector<std::string> interrupt_systems();

// What the paper's Table 2 says of a system, checked by SPIN.
struct PaperCheckingRow {
  std::string states;  // in the paper's precision: "19M"
  double seconds = 0;
  std::uint64_t megabytes = 0;
};

// A system of ours, and the paper's row beside it.
struct CheckedRow {
  std::string name;                       // the paper's columns
  std::optional<PaperCheckingRow> paper;  // none: the paper has no such row
  Verdict expected = Verdict::holds;      // on deadlocks; with a row, the paper's conclusion
  std::string system;                     // the text of the system file
};

// Both halves of the table, in its order; then its last row with the other way of meeting a full
// queue.
std::vector<CheckedRow> table2_rows();

// How the models that the rows' systems `learn:` are learned from a system of ours: the options, by
// the model's name. Throws UsageError for a system that is not among table2_systems().
std::map<std::string, std::map<std::string, std::string>> table2_models(const std::string& system);

// The systems of Table 1 from which all of the models can be learned.
std::vector<std::string> table2_systems();

// One learner of another tool on one model, with a perfect oracle.
struct PeerRun {
  std::string model;           // the file's name without its extension
  std::size_t states, inputs;  // of the model
  std::string tool, learner;   // "LearnLib", "TTT"
  std::uint64_t resets, symbols;
  std::uint64_t equivalence_queries;  // the last one included
  std::optional<double> cpu_seconds;  // of the tool, on another machine than this one
};

// The mean over the 41 models on which L# was compared with others.
struct PeerMean {
  std::string tool, learner;
  double symbols_and_resets;  // a model
};

// Equivalence testing without a perfect oracle, with randomised hybrid ADS.
struct PeerTesting {
  std::string model;
  std::size_t states, inputs;
  double test_symbols;         // mean over many seeds
  std::size_t states_learned;  // of `states`
};

std::span<const PeerRun> peer_runs();
std::span<const PeerMean> peer_means();
std::span<const PeerTesting> peer_testing();

// Whether these are the names of the 41 models, in alphabetical order and nothing besides.
bool are_the_41_models(std::span<const std::string> names);

}  // namespace maide
