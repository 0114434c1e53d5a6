// The processor time of this process so far, all threads together, in seconds.
#pragma once

#include <ctime>

namespace maide::bench {

inline double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace maide::bench
