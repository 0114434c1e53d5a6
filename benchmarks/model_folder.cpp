#include "model_folder.hpp"

#include <algorithm>

#include "maide/base/error.hpp"
#include "maide/formats/model_file.hpp"

namespace maide::bench {

std::vector<Model> read_models(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw UsageError("there is no folder " + folder.string());
  }
  std::vector<Model> models;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".dot") continue;
    models.push_back({entry.path().stem().string(), read_mealy(entry.path())});
  }
  std::ranges::sort(models, {}, &Model::name);
  if (models.empty()) throw UsageError("no .dot files in " + folder.string());
  return models;
}

}  // namespace maide::bench
