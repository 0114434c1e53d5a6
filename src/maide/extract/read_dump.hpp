// From cppcheck's dump to the schema of functions.
//
// It fails closed: each token of a body is used by exactly one node of a tree. A statement that
// leaves a name, a number or a bracket of a call unused becomes `opaque`, and so a hole; code in
// braces that is no function's body is a fault of the sources.
#pragma once

#include "maide/extract/cppcheck_dump.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

// Adds what the configuration has and `sources` has not. A function of a header that several files
// include is read once.
void read_configuration(const DumpConfiguration& dump, Sources& sources);

}  // namespace maide::extract
