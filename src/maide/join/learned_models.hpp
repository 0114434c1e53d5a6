// Models of a system file that are learned when they are needed (`{learn: cyclonedds, with:
// {...}}`). A model is kept beside the file, so that the next check starts at once. Beside it lies
// the cache of its system's answers. So learning that was ended goes on there, and a model that
// turns out to be wrong is refined at the cost of what is new.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/system_file.hpp"

namespace maide {

// The folder, beside the system file, in which learned models are kept.
inline constexpr const char* learned_models_folder = "maide-models";

struct LearnedModelsOptions {
  // What names of files are relative to, and where models are kept; empty: the folder of the system
  // file that asks.
  std::filesystem::path folder;
  std::function<void(const std::string& line)> note;  // told what is learned and what is reused
  RunControl control;
  std::size_t jobs = 0;  // systems that are asked at once; 0: the default (default_jobs())
};

// Reads models that are files. Reads kept models, if they were learned from the same system: the
// system is opened to compare options and versions. Learns the others, with the defaults of `maide
// learn` where `learning:` says nothing else. Learning starts from the model that `start-from:`
// names, or else from the kept model of another version. Throws an Error with its exit status and
// the place in the file that asks for the model; a UsageError is without a place, for the reader of
// the system file adds it.
ModelSource make_learning_source(LearnedModelsOptions options);

std::filesystem::path folder_of(const LearnedModelsOptions& options, const ModelRequest& request);

// Where the model of a request is kept: the system, its options, and a hash of both.
std::filesystem::path kept_model_path(const std::filesystem::path& folder,
                                      const ModelRequest& request);

// What a kept model is to be refined with.
struct RefinementGoal {
  std::vector<std::string> counterexample;  // inputs; empty: none
  // Test it with the default method and this seed besides, whatever `learning:` says.
  bool tests_again = false;
  std::uint64_t seed = 0;
};

struct Refinement {
  std::size_t states_before = 0, states_after = 0;  // of the interface automata
  bool is_new = false;                              // the model is another now
  bool is_stronger = false;                         // it was weak, and is not weak any more
  std::string tests;                                // what it is not refuted by now
};

// Learns the kept model of a request (`learn:`) again, and keeps the result in its place. It starts
// from that model, what is known of its system, the counterexamples of earlier refinements, and the
// goal. What was asked stays in the cache if the call ends early. Errors as above.
Refinement refine_learned_model(const ModelRequest& request, const RefinementGoal& goal,
                                const LearnedModelsOptions& options);

}  // namespace maide
