#include "maide/check/engine.hpp"

#include <unistd.h>

#include <algorithm>

#include "maide/base/error.hpp"
#include "maide/check/native_engine.hpp"
#include "maide/check/spin_engine.hpp"

namespace maide {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return "holds";
    case Verdict::violated: return "violated";
    case Verdict::inconclusive: return "inconclusive";
  }
  return "";
}

std::uint64_t memory_limit_mib(const EngineOptions& options) {
  if (options.memory_mib) return *options.memory_mib;
  const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  return std::max<std::uint64_t>(256, pages * page / 4 * 3 >> 20);
}

std::string why_stopped(const EngineOptions& options) {
  return options.control.stop.stop_requested() ? "interrupted" : "out of time";
}

std::unique_ptr<Engine> make_engine(const std::string& name) {
  if (name == "spin") return std::make_unique<SpinEngine>();
  if (name == "native") return std::make_unique<NativeEngine>();
  throw UsageError("there is no engine '" + name + "'; there is: native, spin");
}

}  // namespace maide
