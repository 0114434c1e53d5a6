// The reference engine: SPIN on the system's Promela (Holzmann, "The model checker SPIN", IEEE TSE
// 1997). Depth-first (pan's breadth-first search loses deadlocks of rendezvous channels),
// exhaustive, without reduction - so that the counts are those of the system - and with a depth
// limit that is raised until it cuts nothing off. Counterexamples are translated back and held
// against the system's semantics; where that is cheap, shorter ones are looked for.
#pragma once

#include "maide/check/engine.hpp"
#include "maide/check/promela_system.hpp"

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
  // `stuck`, X and strong fairness are beyond it.
  std::string obstacle(const Property& property) const override;
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override;
  CutResult find_cut(const System& system, const EngineOptions& options) override;

 private:
  SpinOptions options_;
};

// The run that `spin -t -p` prints, in steps of the system. Throws std::logic_error if it is not
// understood. Exported for tests.
Trace read_spin_run(const std::string& text, const PromelaSystem& promela, const System& system);

}  // namespace maide
