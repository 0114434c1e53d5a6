// The Promela that SPIN is fastest with, other than what is exported: models are bytes that the
// programs' processes share, and a step is a d_step that changes one. The same steps, without
// rendezvous, channels or processes for models; so the same states, but for the one before the
// processes are started, and what SPIN's partial-order reduction could have used.
#pragma once

#include <string>

#include "maide/check/system/system.hpp"

namespace maide::bench {

// Labels are as in write_promela. Of deterministic models without `when_unexplored: stop`; throws
// std::logic_error for others.
std::string write_flat_promela(const System& system);

}  // namespace maide::bench
