// LTSmin as an engine (Kant et al., "LTSmin: High-Performance Language-Independent Model Checking",
// TACAS 2015): `pins2lts-mc` on the system's plug-in (export/system_exporters.hpp), with as many
// threads as EngineOptions says. The search is exhaustive and without reduction, so the counts are
// those of the system. A counterexample is looked for again on one core, breadth-first, so that it
// is a shortest one. It is translated back and held against the system's semantics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "maide/base/subprocess.hpp"
#include "maide/check/engines/engine.hpp"

namespace maide {

struct LtsminOptions {
  std::string explorer = "pins2lts-mc", printer = "ltsmin-printtrace", compiler = "c++";
};

class LtsminEngine : public Engine {
 public:
  explicit LtsminEngine(LtsminOptions options = {}) : options_(std::move(options)) {}
  std::string name() const override { return "ltsmin"; }
  // The only formulas that it takes are `always` of what states show.
  std::string obstacle(const System& system, const Property& property) const override;
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override;
  CutResult find_cut(const System& system, const EngineOptions& options) override;

 private:
  LtsminOptions options_;
};

// What `pins2lts-mc` prints, as far as verdicts need it. Nothing that it does not plainly say
// counts as a complete search: where its table is full it ends as if all were well.
struct LtsminOutput {
  bool is_violated = false;
  bool is_complete = false;       // the search ran to its end
  bool is_table_full = false;     // of the memory that it was given
  std::uint64_t states = 0;       // explored
  std::uint64_t transitions = 0;  // of these
  std::uint64_t peak_bytes = 0;   // of states and queues; a table is reserved besides
  std::string error;              // its first, one line; ""
};
LtsminOutput read_ltsmin_output(const SubprocessResult& result);

// The run that `ltsmin-printtrace` wrote as text with commas, in steps of the system. Throws
// std::logic_error if it is no run. Exported for tests.
Trace read_ltsmin_run(const std::string& text, const System& system);

}  // namespace maide
