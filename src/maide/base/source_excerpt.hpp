// The line of a file in which something is wrong, and a caret under the place, as compilers show
// them.
#pragma once

#include <string>

#include "maide/base/error.hpp"

namespace maide {

// Two lines, each ended; "" if the place is not known to the column or the file cannot be read.
// Long lines are cut to what stands around the place, and what cannot be printed is a '?'.
std::string source_excerpt(const SourcePosition& position);

}  // namespace maide
