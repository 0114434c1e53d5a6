// What decides properties of systems: SPIN, or an engine of our own. Engines answer for one
// property at a time and know nothing of what a verdict rests on; that is check_system's part.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "maide/base/run_control.hpp"
#include "maide/check/trace.hpp"

namespace maide {

enum class Verdict : std::uint8_t { holds, violated, inconclusive };
std::string to_string(Verdict verdict);

struct PropertyResult {
  std::string name;
  Verdict verdict = Verdict::inconclusive;
  std::string reason;             // of an inconclusive verdict, one line; else empty
  std::uint64_t states = 0;       // explored; with a formula, of its product with the system
  std::uint64_t transitions = 0;  // explored
  double seconds = 0;             // of the search, wall clock
  std::uint64_t peak_bytes = 0;   // memory of the search
  std::optional<Trace> trace;     // of a violation
};

// Whether some run leaves what was learned.
struct CutResult {
  Verdict verdict = Verdict::inconclusive;  // holds: no run does
  std::string reason;                       // of an inconclusive verdict
  std::optional<Trace> trace;               // its last step leaves what was learned
};

struct EngineOptions {
  std::optional<std::uint64_t> memory_mib;  // limit of a search; none: most of the machine's
  RunControl control;
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual std::string name() const = 0;
  // What keeps this engine from checking the property, one line; "" if nothing does.
  virtual std::string obstacle(const Property& property) const = 0;
  // Decides the property, which must have no obstacle. Limits and interruptions make the verdict
  // inconclusive. Throws UsageError if the engine cannot work at all (a missing tool, a full disk).
  virtual PropertyResult check(const System& system, const Property& property,
                               const EngineOptions& options) = 0;
  virtual CutResult find_cut(const System& system, const EngineOptions& options) = 0;
};

// The engine of that name: `native`, `spin`. Throws UsageError for others.
std::unique_ptr<Engine> make_engine(const std::string& name);

}  // namespace maide
