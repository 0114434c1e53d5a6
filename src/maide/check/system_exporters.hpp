// The languages that whole systems are exported to, in one table: `maide export SYSTEM --to NAME`.
// All have the same steps: one rendezvous, one `quiet` or one choice is one transition.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <span>
#include <string_view>

#include "maide/base/run_control.hpp"
#include "maide/check/system.hpp"

namespace maide {

struct SystemExportOptions {
  std::uint64_t bytes = 0;  // most memory for a state graph; 0: three quarters of the machine's
  RunControl control;
};

struct SystemExporter {
  std::string_view name;  // as in --to
  std::string_view summary;
  void (*write)(std::ostream& out, const System& system, const SystemExportOptions& options);
};

std::span<const SystemExporter> system_exporters();
// Throws UsageError "unknown format 'x' for a system; known are: ...".
const SystemExporter& find_system_exporter(std::string_view name);

}  // namespace maide
