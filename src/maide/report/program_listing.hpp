// The programs' text with the lines marked at which each of them stands when a counterexample ends,
// and those that it repeats for ever: where in the code to look.
#pragma once

#include <iosfwd>

#include "maide/check/system.hpp"
#include "maide/check/trace.hpp"

namespace maide {

// Writes a <pre class="program"> for each program, with line numbers. Lines are <mark>s of class
// `waits` or `loops`, or plain. Programs whose source is not known are left out.
void write_program_listing(std::ostream& out, const System& system, const Trace& trace);

}  // namespace maide
