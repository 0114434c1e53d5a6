// Automata in the Hanoi Omega-Automata format, version 1 (Babiak et al., CAV 2015), that the tools
// of the field exchange (Spot, Owl, PRISM, ltl3ba). Atomic propositions are atoms of formulas:
// "planner@sent", "via!gap". Written: transition-based generalised Buchi acceptance. Read: that, or
// on states, Buchi, or none (`t`); labels on transitions or states, or implicit; aliases.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/check/formula.hpp"
#include "maide/check/ltl_automaton.hpp"

namespace maide {

// `name`: what it is the automaton of. O(size).
void write_hoa(std::ostream& out, const LtlAutomaton& automaton, const FormulaScope& scope,
               std::string_view name);

// The one automaton of the text. `file` is for messages. Throws ParseError (file:line:column):
// syntax, an atomic proposition that is no atom of the system, alternation, other acceptance, more
// than 64 propositions or marks, labels that stand for more than 4096 conjunctions.
LtlAutomaton read_hoa(std::string_view text, const std::string& file, const FormulaScope& scope);

}  // namespace maide
