// Moore machines, and DFAs among them, as Mealy machines: a transition's output is that of the
// state it leads to (for a DFA "accept" or "reject"), so any learner of Mealy machines learns them.
// What that loses is the output of the initial state, which no input shows: it stays beside the
// machine, in `origin`, with the kind ("type": "moore" or "dfa").
//
// A minimal Mealy machine may take two states for one that differ in their own output alone;
// split_states() makes two of them again, which gives the minimal Moore machine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide {

inline constexpr const char* accepting_output = "accept";  // of a DFA's states
inline constexpr const char* rejecting_output = "reject";

// The output of the initial state, where the machine stands for a Moore machine or DFA.
std::optional<std::string> find_initial_output(const Mealy& machine);
// Says that the machine stands for one: `type` is "moore" or "dfa".
void mark_as_moore(Mealy& machine, const std::string& type, const std::string& initial_output);

// The output of each state: that of all transitions into it, and of the initial state the one that
// the machine is marked with. Nothing if it is not marked, or a state would have two outputs.
// A state that no transition leads to has the initial one's. O(n k).
std::optional<std::vector<std::string>> find_state_outputs(const Mealy& machine);

// An equivalent machine, marked alike, whose states have one output each, reachable states only, in
// breadth-first order; minimal as a Moore machine if `machine` is minimal. `machine` must be marked
// and complete. O(n k times the outputs of a state).
Mealy split_states(const Mealy& machine);

}  // namespace maide
