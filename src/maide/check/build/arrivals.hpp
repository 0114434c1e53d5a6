// The steps of nobody: what programs have sent arrives, or is lost.
#pragma once

#include "maide/check/build/declarations.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

// The programs were made with `actions`.
void add_arrivals(const Declarations& file, const Names& names, System& system,
                  ModelActions& actions);

}  // namespace maide
