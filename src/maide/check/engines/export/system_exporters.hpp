// The formats that whole systems are exported to: their table (`maide export SYSTEM --to NAME`),
// and the writers of .aut, mCRL2, SMV and PINS. Promela has a file of its own
// (promela_system.hpp). All formats have the same steps: one step is one transition
// (step_rules.hpp).
#pragma once

#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>

#include "maide/base/run_control.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct SystemExportOptions {
  std::uint64_t bytes = 0;  // most memory for a state graph; 0: three quarters of the machine's
  RunControl control;
};

struct SystemExporter {
  std::string_view name;  // as in --to
  std::string_view summary;
  // Takes a system with several components even if it uses the second edition. (There an error,
  // which stops its component, stops them all.)
  bool takes_components = false;
  void (*write)(std::ostream& out, const System& system, const SystemExportOptions& options);
};

std::span<const SystemExporter> system_exporters();
// Throws UsageError "unknown format 'x' for a system; known are: ...".
const SystemExporter& find_system_exporter(std::string_view name);

// ---- Aldebaran ----
//
// The global state graph of a system in Aldebaran's format .aut (CADP, mCRL2, LTSmin). It has a
// state for each reachable one before any cut, and a transition for each step, labelled by its
// action ("planner via?write"; step_action.hpp). A step that leaves what was learned is a self-loop
// that ends in "beyond", so no such state looks like a deadlock. A state without a transition is a
// deadlock, or all programs have ended there.
struct GraphSize {
  std::uint64_t states = 0, transitions = 0;
};

// The graph is walked twice, because its size stands in the first line: once to number its states,
// breadth first, once to write. Memory: some 16 bytes a state, 8 more for each further 64 bits that
// a state needs. Throws Interrupted, or Error (inconclusive) if more than `bytes` are needed.
GraphSize write_aut(std::ostream& out, const System& system, std::uint64_t bytes,
                    const RunControl& control);

// ---- mCRL2 ----
//
// A whole system in mCRL2 (Groote & Mousavi, "Modeling and Analysis of Communicating Systems",
// 2014): a process for each state of a component, and the components in parallel. A program's half
// of a rendezvous, `p_in_via_write`, and the model's, `m_in_via_write`, communicate to
// `in_via_write`, whose argument is the program. A step with several models has a part for each.
// Only whole steps are allowed, so one action is one step. Where programs may come to an error, a
// process `Running` takes part in every step until then. The states are those of the system before
// any cut: `beyond_via_write` changes nothing.
void write_mcrl2(std::ostream& out, const System& system);

// ---- SMV ----
//
// A whole system for NuSMV and nuXmv: a module for each model and each program, and one input
// variable of main, `step`, that says which of them move together. One transition is one step, and
// the states are those of the system before any cut. Where nothing can happen, `step` is `idle` and
// the last state repeats, because SMV wants total relations. A step beyond what was learned
// (`beyond_...`) changes nothing. `INVARSPEC !deadlock` is the system's `deadlock`, and `INVARSPEC
// !is_error` its `error`. Programs define `ended` and `at_LABEL` for properties of one's own.
void write_smv(std::ostream& out, const System& system);

// ---- PINS ----
//
// A whole system as a plug-in of LTSmin (Kant et al., "LTSmin: High-Performance
// Language-Independent Model Checking", TACAS 2015): one C++ file, which a compiler makes a shared
// object of, without LTSmin's headers. LTSmin's backends explore it with many cores, symbolically,
// or over MPI.
//
// The state has a slot for each program's place, one for nobody's if he has actions, then one for
// each model's state, then `halted` if programs may come to an error. A group of transitions is
// what one program does with its models, from whatever place; its action is the step's name
// (ActionNames). The states are those of the system before any cut, and one transition is one step;
// a cut is a self-loop. Guards and their matrices are there for partial-order reduction. Labels of
// states are:
//
//   valid_end_state   all programs have ended or may rest. LTSmin's --deadlock is the system's by
//                     that, unless programs may die.
//   deadlock, error
//   beyond            a step can go beyond what was learned, and is cut.
//   always_NAME       of a property NAME that is `always` what states show.
void write_pins(std::ostream& out, const System& system, std::span<const Property> properties);

// What keeps the property from being a label of states, "sees events, and not states alone"; "" if
// nothing does.
std::string why_no_label(const System& system, const Property& property);

}  // namespace maide
