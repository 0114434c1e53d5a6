#include "maide/workflow/read_traces.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#include "maide/automata/words.hpp"
#include "maide/base/file.hpp"
#include "maide/learn/cache_file.hpp"

namespace maide {
namespace {

TraceLog read_cache(const std::filesystem::path& path, const RunControl& control) {
  CacheFile file(path);
  TraceLog log{file.inputs(), file.outputs(), {}, path.string()};
  file.for_each([&](const Word& inputs, const Word& outputs) {
    if (log.traces.size() % 4096 == 0) control.check("reading the cache");
    // A word that did not complete has fewer outputs.
    log.traces.push_back({head(inputs, outputs.size()), outputs});
  });
  return log;
}

// By its first bytes. What is no regular file can be read once only, and is no database.
bool is_sqlite(const std::filesystem::path& path) {
  constexpr std::string_view magic = "SQLite format 3";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::string start(magic.size(), '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), std::ssize(start));
  return start == magic;
}

}  // namespace

TraceLog read_traces(const std::filesystem::path& path, const RunControl& control) {
  if (is_sqlite(path)) return read_cache(path, control);
  return read_trace_log(read_file(path, control), path.string(), control);
}

}  // namespace maide
