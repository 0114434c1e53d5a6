// Passive learning: a Mealy machine from a log alone, by merging states of the tree of all traces.
// The algorithm is RPNI (Oncina & Garcia, "Inferring regular languages in polynomial updated time",
// 1992) in the blue-fringe form with evidence (Lang, Pearlmutter & Price, "Results of the Abbadingo
// One DFA learning competition and a new evidence-driven state merging algorithm", ICGI 1998).
//
// The *red* states are found. The *blue* ones are their children, still roots of trees. The next
// blue state is the one of which the log shows most. It merges with the red state that shares most
// edges with it (the evidence), or becomes red if it contradicts all red states. Heavy states come
// first, so that a wrong merge with little evidence does not mislead the others.
//
// Example: of the log `a` 0, `a` 0 the state behind the first `a` merges with the start: a machine
// of one state. Of the log `a` 0, `a` 1 it does not, and becomes red.
//
// Invariant: the red states and the trees below them answer every trace as the log does. A machine
// whose log is rich enough is found exactly. Otherwise the result is one of many machines that
// agree with the log, and what it says beyond the log is a guess. O(red states x edges of the log's
// tree), and O(blue states) for each merge.
#pragma once

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/formats/trace_log.hpp"

namespace maide {

struct PassiveModel {
  // Complete and minimal: where the log has nothing, a self-loop with output "unexplored".
  Mealy machine;
  std::size_t unseen_transitions = 0;  // of the states before minimisation
};

// Throws UsageError if the log contradicts itself (the system is not deterministic) or has no
// inputs; Interrupted.
PassiveModel learn_passively(const TraceLog& log, const RunControl& control = {});

}  // namespace maide
