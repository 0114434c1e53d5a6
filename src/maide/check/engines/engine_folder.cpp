#include "maide/check/engines/engine_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "maide/base/error.hpp"

namespace maide {

namespace fs = std::filesystem;

std::string complaint(const SubprocessResult& result) {
  std::string text = (result.out + result.err).substr(0, 300);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

SubprocessResult EngineFolder::run(const std::vector<std::string>& command,
                                   std::optional<std::chrono::milliseconds> limit) const {
  SubprocessOptions options;
  options.folder = path();
  options.time_limit = limit;
  return run_program(command, options, control_);
}

SubprocessResult EngineFolder::start_tool(const std::vector<std::string>& command,
                                          const std::string& what) const {
  try {
    return run(command);
  } catch (const UsageError&) {
    throw UsageError(
        fmt::format("the engine {} needs {}, and '{}' cannot be run: `maide doctor` says what to "
                    "install",
                    engine_, what, command.front()));
  }
}

SubprocessResult EngineFolder::run_tool(const std::vector<std::string>& command,
                                        const std::string& what, const std::string& product) const {
  SubprocessResult result = start_tool(command, what);
  std::error_code ignored;
  const bool has_product = product.empty() || fs::exists(path() / product, ignored);
  if (result.succeeded() && has_product) return result;
  const fs::space_info space = fs::space(path(), ignored);
  if (space.available < 1 << 20) {
    throw UsageError(
        fmt::format("no space left for what {} generates ({})", engine_, path().string()));
  }
  throw UsageError(fmt::format("{} failed: {}", what, complaint(result)));
}

}  // namespace maide
