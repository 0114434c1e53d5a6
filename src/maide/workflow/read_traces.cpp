#include "maide/workflow/read_traces.hpp"

#include <string>

#include "maide/base/file.hpp"
#include "maide/learn/cache_file.hpp"

namespace maide {
namespace {

TraceLog read_cache(const std::filesystem::path& path) {
  CacheFile file(path);
  TraceLog log{file.inputs(), file.outputs(), {}, path.string()};
  file.for_each([&](const Word& inputs, const Word& outputs) {
    // A word that did not complete has fewer outputs.
    log.traces.push_back(
        {Word(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(outputs.size())),
         outputs});
  });
  return log;
}

}  // namespace

TraceLog read_traces(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  if (text.starts_with("SQLite format 3")) return read_cache(path);
  return read_trace_log(text, path.string());
}

}  // namespace maide
