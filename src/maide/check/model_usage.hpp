// What the programs of a system use of each of its models: what has to be written of them where a
// system is exported, and whether a run may leave what was learned at all.
#pragma once

#include <set>
#include <vector>

#include "maide/check/system.hpp"

namespace maide {

struct ModelUsage {
  struct Instance {
    std::set<Symbol> inputs;   // that are given
    std::set<Symbol> cutting;  // those of them that may be beyond what was learned, while the model
                               // says `stop`, as far as its automaton alone tells
    bool quiet = false;        // some program has an arm for it
  };

  explicit ModelUsage(const System& system);

  std::vector<Instance> instances;  // by model
  bool any_cut = false;             // else no run can be cut
};

}  // namespace maide
