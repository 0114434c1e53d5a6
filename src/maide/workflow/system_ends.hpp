// Where a learned system crashes or hangs: each end with a shortest word that causes it, for
// whoever has to mend it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/sul/ia_translator.hpp"

namespace maide {

struct SystemEnd {
  std::string output;             // "crash" or "hang"
  std::vector<std::string> word;  // the shortest inputs that lead there; the last one does it
  std::size_t states = 0;         // in so many states of the model that input does it
  std::string reason;             // in the wrapper's words; "" if only a cache knows of it
};

// One for each kind of end and input that causes it, shortest words first. The reason is that of
// the word itself where the system was asked it, else that of another with the same last input.
// O(transitions + words).
std::vector<SystemEnd> find_system_ends(const InterfaceAutomaton& automaton,
                                        const IaTranslator& translator);

// "crash: write close (the wrapper was killed by signal 6 (Aborted))"
std::string to_string(const SystemEnd& end);
// The same of all, joined by "; ".
std::string to_string(std::span<const SystemEnd> ends);

}  // namespace maide
