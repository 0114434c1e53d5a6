// Figure 3 of "Reverse Engineering of Middleware for Verification of Robot Control Architectures"
// (Khalili, Natale, Tacchella, SIMPAR 2014) as data: a port with one reader, one writer, and a
// thread that interrupts the writer. One would expect that interrupt lets a waiting write go; the
// paper found that in YARP it waits for the write itself.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide {

// The Mealy machines (eager) of the two, over write, read and interrupt, with the outputs message,
// written, failed (of the write) and done (of the interrupt). "refused": the call before has not
// returned.
Mealy expected_interrupt_model();
Mealy paper_interrupt_model();

// The options by which a system is learned with these inputs and outputs.
std::map<std::string, std::string> interrupt_options();

// The systems of ours whose writer can be interrupted.
std::vector<std::string> interrupt_systems();

}  // namespace maide
