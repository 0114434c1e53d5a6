// A program alone, of a system whose models are there.
#pragma once

#include <string>

#include "maide/check/language/program.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/text/scalar_text.hpp"

namespace maide {

// Parses a program and unrolls it. Its models are those of the system, whose actions grow. Throws
// ParseError with the place in the file: syntax, unknown names, a loop that never steps, more than
// max_control_states. O(control states).
Program parse_program(const std::string& name, const ScalarText& text, System& system);

}  // namespace maide
