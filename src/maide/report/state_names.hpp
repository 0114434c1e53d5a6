// Names of a model's states for people, in place of numbers. A state of an interface automaton is
// named by what it holds ("holds 2"), who waits in a call ("reader waits") and what is due
// ("message due"). All of it is read off the automaton: what it holds is the number of outputs that
// can be had by asking alone (check/verdict/message_account.hpp). Where that says nothing, and
// where it says the same of two states, the shortest word that leads there is the name.
//
// A name does not imply that the real system keeps messages; only that the model behaves so.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"

namespace maide {

// By state. No two are the same. O(states x transitions x outputs).
std::vector<std::string> name_states(const InterfaceAutomaton& automaton);
std::vector<std::string> name_states(const NondeterministicMealy& machine);

// "at the start", "after write 3 times, read".
std::string describe_word(const std::vector<std::string>& word);

}  // namespace maide
