// Maide's own engine: explicit states, packed (packed_system.hpp, state_table.hpp). Deadlocks, cuts
// and invariants by breadth-first search, so that what it shows is a shortest run; `stuck` and all
// other formulas by an on-the-fly search for a fair cycle (fair_cycle.hpp).
#pragma once

#include "maide/check/engine.hpp"

namespace maide {

class NativeEngine : public Engine {
 public:
  std::string name() const override { return "native"; }
  std::string obstacle(const Property& property) const override;
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override;
  CutResult find_cut(const System& system, const EngineOptions& options) override;
};

}  // namespace maide
