// The models of a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide::bench {

struct Model {
  std::string name;  // the file's, without .dot
  Mealy machine;
};

// The .dot files of a folder, by name. Throws UsageError if there are none, or one is no complete
// Mealy machine.
std::vector<Model> read_models(const std::filesystem::path& folder);

}  // namespace maide::bench
