// Random runs of a composed system, as a robot's programs would run: who steps next is left to
// chance, so with probability one every program that can go on goes on.
#pragma once

#include <cstddef>

#include "maide/base/random.hpp"
#include "maide/check/trace.hpp"

namespace maide {

// A run of at most `most_steps` steps; shorter where nothing can happen any more, or where only an
// input that was never tried could. First the program is drawn, then its step, all alike.
// O(steps x programs x edges).
Trace draw_run(const System& system, std::size_t most_steps, Random& random);

}  // namespace maide
