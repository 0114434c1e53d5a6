// Black-box checking: a system is checked with models that are still being learned, and each
// verdict is tried on the real system before it is believed.
//
//   check --- violated --> replay the counterexample --- followed ------> violated, and it is so
//     ^                            |
//     |                            not followed: what the real system did otherwise is a
//     |                            counterexample for the learner of that instance
//     |--- a new model <-----------|
//     |                            |--- found something
//     '---- else ------> test every learned model again --- found nothing --> the verdict stands
//
// Peled, Vardi & Yannakakis, "Black box checking", FORTE 1999; Groce, Peled & Yannakakis, "Adaptive
// model checking", TACAS 2002; Meijer & van de Pol, "Sound black-box checking in the LearnLib",
// NASA Formal Methods 2018. "Holds" stays as good as the tests: they are named in the assumptions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "maide/join/check_system_file.hpp"
#include "maide/join/learned_models.hpp"

namespace maide {

// A model that turned out to be wrong.
struct RefinementRound {
  std::string instance;
  std::string cause;              // "the counterexample to deadlock", "a test"
  std::vector<std::string> word;  // inputs of the counterexample; empty: the tests found theirs
  std::string expected, seen;     // the last input's outputs: the model's, the real ones
  std::size_t states_before = 0, states_after = 0;  // of the interface automata
};

// "via: 4 -> 6 states; after write write read read the model says quiet, the real system message".
std::string to_string(const RefinementRound& round);

struct RefinementOptions {
  LearnedModelsOptions models;
  std::vector<ConstantSetting> settings;
  std::size_t most_rounds = 100;  // then the verdict is inconclusive
  // A nondeterministic system is given so many chances to follow a counterexample.
  std::size_t most_attempts = 20;
  std::uint64_t seed = 1;  // of the tests after a verdict
  std::function<void(const RefinementRound&)> on_round;
};

// The system is that with the last models; the assumptions of its report say what was replayed and
// tested.
struct RefinedCheck : CheckedSystem {
  std::vector<RefinementRound> rounds;
};

// Reads and checks the system of `path` until its verdict is confirmed. A verdict that cannot be -
// the real system does not follow and no learner can help, too many rounds - is inconclusive, with
// the reason. Throws what reading, checking, learning and replaying throw; refined models are kept
// all the same.
RefinedCheck check_and_refine(const std::filesystem::path& path, Engine& engine,
                              const CheckRequest& request, const RefinementOptions& options);

}  // namespace maide
