// A whole system in mCRL2 (Groote & Mousavi, "Modeling and Analysis of Communicating Systems",
// 2014): a process for each state of a component, the components in parallel. A program's half of a
// rendezvous, `p_in_via_write`, and the model's, `m_in_via_write`, communicate to `in_via_write`,
// whose argument is the program, and only that is allowed: one action is one step. The states are
// those of the system before any cut: `beyond_via_write` changes nothing.
#pragma once

#include <iosfwd>

#include "maide/check/system.hpp"

namespace maide {

void write_mcrl2(std::ostream& out, const System& system);

}  // namespace maide
