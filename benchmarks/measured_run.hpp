// A program run to its end, with the processor time and the peak of memory that the kernel counted
// for it (wait4). Other than run_program, it runs on one core.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace maide::bench {

struct MeasuredRun {
  int exit_status = 0;           // 128 + n if signal n ended it
  double seconds = 0;            // of the processor, user and system
  std::uint64_t peak_bytes = 0;  // resident
  std::string output;            // standard output and standard error
};

// `seconds`: of the processor; more is not given. Throws UsageError if it cannot be started.
MeasuredRun run_measured(const std::vector<std::string>& command,
                         const std::filesystem::path& folder, unsigned seconds);

}  // namespace maide::bench
