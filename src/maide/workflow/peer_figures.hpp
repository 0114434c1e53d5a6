// What other tools for learning automata ask, as data to stand beside our own measurements: on
// models that are widely used, known here by their file's name and their size. docs/bench.md names
// the source of each figure. None of it was measured by this program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace maide {

// One learner of another tool on one model, with a perfect oracle.
struct PeerRun {
  std::string_view model;             // the file's name without its extension
  std::size_t states, inputs;         // of the model
  std::string_view tool, learner;     // "LearnLib", "TTT"
  std::uint64_t resets, symbols;      // large counts are rounded
  std::uint64_t equivalence_queries;  // the last one included
  std::optional<double> cpu_seconds;  // of the tool, on another machine than this one
};

// The mean over the 41 models on which L# was compared with others.
struct PeerMean {
  std::string_view tool, learner;
  double symbols_and_resets;  // a model
};

// Equivalence testing without a perfect oracle, with randomised hybrid ADS.
struct PeerTesting {
  std::string_view model;
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
