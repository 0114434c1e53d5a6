// A system as JSON and back, with all that engines, traces and reports read of it: for dumps of the
// stages of reading (build/stage_dump.hpp).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// Edges and transitions are lists of numbers, for there may be millions. All four throw Interrupted
// when the control says stop. O(system).
nlohmann::json json_of(const System& system, const RunControl& control = {});
nlohmann::json json_of(const InterfaceAutomaton& automaton, const RunControl& control = {});

// The way back. JSON that json_of() did not make throws nlohmann::json::exception, or gives what
// must not be used: numbers are not checked.
System system_of(const nlohmann::json& from, const RunControl& control = {});
InterfaceAutomaton automaton_of(const nlohmann::json& from, const RunControl& control = {});

}  // namespace maide
