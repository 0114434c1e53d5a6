// The reference engine: SPIN on the system's Promela (Holzmann, "The model checker SPIN", IEEE TSE
// 1997). The search is exhaustive and without reduction, so the counts are those of the system. It
// is depth-first, because pan's breadth-first search loses deadlocks of rendezvous channels. The
// depth limit is raised until it cuts nothing off. Counterexamples are translated back and held
// against the system's semantics. Where that is cheap, shorter ones are looked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/export/promela_system.hpp"

namespace maide {

struct SpinOptions {
  std::string spin = "spin", compiler = "cc";  // programs
  std::string optimisation;                    // for the compiler; empty: by the size of the system
  bool shortens = true;                        // look for shorter counterexamples
};

class SpinEngine : public Engine {
 public:
  explicit SpinEngine(SpinOptions options = {}) : options_(std::move(options)) {}
  std::string name() const override { return "spin"; }
  // `stuck`, X, strong fairness and `fair` are beyond it.
  std::string obstacle(const System& system, const Property& property) const override;
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override;
  CutResult find_cut(const System& system, const EngineOptions& options) override;

 private:
  SpinOptions options_;
};

// The run that `spin -t -p` prints, in steps of the system. Throws std::logic_error if it is not
// understood. Exported for tests.
Trace read_spin_run(const std::string& text, const PromelaSystem& promela, const System& system);

// What SPIN's verifier `pan` prints, as far as verdicts need it. Nothing that it does not plainly
// say counts as a complete search.
struct PanOutput {
  std::uint64_t errors = 0;
  std::uint64_t states = 0;  // stored
  std::uint64_t transitions = 0;
  std::uint64_t peak_bytes = 0;
  std::string first_error;          // "invalid end state (at depth 18)"
  bool is_depth_truncated = false;  // "max search depth too small"
  bool is_memory_exhausted = false;
  // The search ran to its end, and no limit cut a part of it off.
  bool is_complete = false;
};

// Nothing if the text is not the output of a verifier that came to its end.
std::optional<PanOutput> parse_pan_output(const std::string& text);

}  // namespace maide
