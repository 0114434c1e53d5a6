// Logs of a system from a file: lines of JSON (formats/trace_log.hpp), or the cache of a learning
// run (learn/cache_file.hpp), which is seen from its first bytes.
#pragma once

#include <filesystem>

#include "maide/base/run_control.hpp"
#include "maide/formats/trace_log.hpp"

namespace maide {

// Throws UsageError if the file cannot be read, ParseError for its text, Interrupted.
TraceLog read_traces(const std::filesystem::path& path, const RunControl& control = {});

}  // namespace maide
