// Transition-based generalised Buchi automata over a system's atoms: their type, the translation of
// a formula of linear-time temporal logic, questions about runs, and the Hanoi format.
//
// The automaton of a formula accepts the runs on which the formula holds. The translation is Gastin
// & Oddoux's ("Fast LTL to Buchi automata translation", CAV 2001): first a very weak alternating
// automaton whose states are the formula's temporal parts, then the automaton of its conjunctions.
// Implied transitions are left out, and equivalent states merged, as it is built.
//
// Example: `G F a` is one state with two loops, one under `true`, and one under `a` that has a
// mark. A run with `a` again and again is accepted, and one with `a` three times is not.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/ltl/formula.hpp"

namespace maide {

// Which atoms of a list must be true, and which false, as bit masks.
struct Letter {
  std::uint64_t positive = 0, negative = 0;
  // `valuation`: the atoms that are true.
  bool allows(std::uint64_t valuation) const {
    return (positive & ~valuation) == 0 && (negative & valuation) == 0;
  }
  bool is_contradiction() const { return (positive & negative) != 0; }
  auto operator<=>(const Letter&) const = default;
};

// A run is accepted if it has a path on which each mark comes again and again.
struct LtlAutomaton {
  struct Transition {
    Letter letter;
    std::uint32_t target = 0;
    std::uint64_t marks = 0;
    auto operator<=>(const Transition&) const = default;
  };
  std::vector<Atom> atoms;  // the bits of letters
  unsigned mark_count = 0;
  std::vector<std::vector<Transition>> states;
  std::vector<std::uint32_t> initial;
  // The state that accepts everything: a run that reaches it satisfies the formula whatever comes.
  // no_state if there is none.
  static constexpr std::uint32_t no_state = ~std::uint32_t{0};
  std::uint32_t universal = no_state;

  std::uint64_t all_marks() const;
  bool operator==(const LtlAutomaton&) const = default;
};

// Most atoms, and most temporal parts, of a formula.
inline constexpr std::size_t max_automaton_atoms = 64;
inline constexpr std::size_t max_temporal_parts = 64;

// Throws UsageError for more atoms or temporal parts than that, or more than 100,000 states: at
// most 2^(temporal parts) in theory, a handful in practice. Throws Interrupted when the control
// says to stop.
LtlAutomaton translate(const Formula& formula, const RunControl& control = {});

// A state that goes to itself on every letter with every mark, or no_state.
std::uint32_t find_universal(const LtlAutomaton& automaton);

// By state: whether a run may wait in it for as long as it likes, whatever happens, without being
// accepted for that: it goes to itself on every letter, no path leads back to it, its own
// transitions lack a mark, and where it goes from there depends on no event. (So one of a system's
// runs to a state does as well as another.) All false for more than 1,000 states.
std::vector<bool> find_waiting(const LtlAutomaton& automaton);

// Whether it accepts no run at all. O(transitions).
bool accepts_nothing(const LtlAutomaton& automaton);

// Whether the automaton accepts the run with positions 0..length-1, of which loop..length-1 repeat
// for ever; `valuations`: the atoms that are true, by position. O(transitions x length).
bool accepts(const LtlAutomaton& automaton, const std::vector<std::uint64_t>& valuations,
             std::size_t loop);

// Whether it accepts every run that begins with `valuations`, as far as its universal state tells:
// true is right, false may only be unknown. O(transitions x length).
bool accepts_whatever_comes(const LtlAutomaton& automaton,
                            const std::vector<std::uint64_t>& valuations);

// ---- The Hanoi Omega-Automata format ----
//
// Version 1 (Babiak et al., CAV 2015), which the tools of the field exchange (Spot, Owl, PRISM,
// ltl3ba). Atomic propositions are atoms of formulas: "planner@sent", "via!gap". Written:
// transition-based generalised Buchi acceptance. Read: that, acceptance on states, Buchi, or none
// (`t`); labels on transitions or states, or implicit; aliases.

// `name`: what it is the automaton of. O(size).
void write_hoa(std::ostream& out, const LtlAutomaton& automaton, const FormulaScope& scope,
               std::string_view name);

// The one automaton of the text. `file` is for messages. Throws ParseError (file:line:column):
// syntax, an atomic proposition that is no atom of the system, alternation, other acceptance, more
// than 64 propositions or marks, labels that stand for more than 4096 conjunctions.
LtlAutomaton read_hoa(std::string_view text, const std::string& file, const FormulaScope& scope);

}  // namespace maide
