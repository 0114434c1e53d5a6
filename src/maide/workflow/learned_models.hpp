// Models of a system file that are learned when they are needed (`{learn: cyclonedds, with:
// {...}}`) and kept beside the file, so that the next check starts at once.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "maide/base/run_control.hpp"
#include "maide/check/system_file.hpp"

namespace maide {

// The folder, beside the system file, in which learned models are kept.
inline constexpr const char* learned_models_folder = "maide-models";

struct LearnedModelsOptions {
  std::filesystem::path folder;                       // of the system file
  std::function<void(const std::string& line)> note;  // told what is learned and what is reused
  RunControl control;
  std::size_t jobs = 0;  // systems that are asked at once; 0: the default (default_jobs())
};

// Reads models that are files, reads kept models that were learned from the same system (options
// and versions; it is opened to see), and learns the others with the defaults of `maide learn`.
// What goes wrong is an Error with its exit status and the place that asks for it.
ModelSource make_learning_source(LearnedModelsOptions options);

// Where the model of a request is kept: the system, its options, and a hash of both.
std::filesystem::path kept_model_path(const std::filesystem::path& folder,
                                      const ModelRequest& request);

}  // namespace maide
