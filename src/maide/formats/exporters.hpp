// The formats that models are exported to: their table (`maide export --to NAME`), and the writers
// of mCRL2, C++, Promela and SMV. DOT and .aut are read, too, so they are in model_file.hpp.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/formats/labelled_graph.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {

struct ExportOptions {
  std::string name = "Model";  // of the class, where the format has one
  MarkLoss marks = MarkLoss::refuse;
};

struct Exporter {
  std::string_view name;       // as in --to
  std::string_view extension;  // of its files, with the dot
  std::string_view summary;
  void (*write)(std::ostream& out, const Model& model, const ExportOptions& options);
  bool takes_machines_alone = false;  // an interface automaton is a UsageError
};

std::span<const Exporter> exporters();
// Throws UsageError "unknown format 'x'; known are: ...". `besides` are further names for it.
const Exporter& find_exporter(std::string_view name,
                              std::initializer_list<std::string_view> besides = {});

// The Mealy machine for a format that has one answer to each input. A partial one answers the
// others with `refused`, and stays where it is. None of an interface automaton. Throws UsageError
// for a nondeterministic machine: `format` is for its message.
std::optional<Mealy> completed_machine(const Model& model, std::string_view format);

// ---- mCRL2 ----
//
// (Groote & Mousavi, "Modeling and Analysis of Communicating Systems", 2014.) A process for each
// state, one action a transition. A Mealy machine's transition is the multi-action of its input and
// its output. An input that was never tried is a self-loop `unexplored_NAME`, so that it does not
// look refused.

// As many states and transitions as the model, and a self-loop for each mark.
void write_mcrl2(std::ostream& out, const Model& model);

// Keywords and the names of predefined sorts and functions.
std::span<const std::string_view> mcrl2_reserved();

// ---- C++ ----
//
// One header with a state machine class that needs the standard library alone; transitions are
// tables. A Mealy machine has `Output step(Input)`. An interface automaton has inputs that are
// given (can, input) and outputs that are taken (is_due, take); "refused" and "never tried" stay
// different (try_input).

// `class_name` becomes an identifier. Throws UsageError for a nondeterministic interface automaton:
// a class has one next state. O(states x symbols).
void write_cpp(std::ostream& out, const Model& model, const std::string& class_name);

// ---- Promela ----
//
// SPIN's language, in the encoding of the paper. Each automaton is one process type, which receives
// inputs on InChannel and emits outputs on OutChannel. Both are rendezvous channels and parameters
// of the type. Each transition is one atomic step. Every state is a valid end state: a model may
// stop anywhere, it is the programs that deadlock.

// What an input does where it was never tried (unexplored, or an absorbed self-loop).
enum class PromelaUnexplored : std::uint8_t {
  stop,  // it is taken, and the process goes to the label end_unexplored, where it blocks
  wait,  // it is not possible
  drop,  // it is taken and nothing changes
};

struct PromelaProctypeOptions {
  // A Promela identifier or number for each symbol of the automaton's alphabets.
  std::vector<std::string> inputs, outputs;
  PromelaUnexplored unexplored = PromelaUnexplored::stop;
};

// `proctype NAME(chan InChannel; chan OutChannel) { ... }`. One pan state for each state (with
// `stop`, and something unexplored, one more). O(size).
void write_promela_proctype(std::ostream& out, const InterfaceAutomaton& automaton,
                            const std::string& name, const PromelaProctypeOptions& options);

// A complete file that spin runs: the model, declared names of its symbols, and an environment that
// does everything that the model lets it do. A Mealy machine answers each input by one output.
// Inputs that were never tried are taken and end in end_unexplored.
void write_promela(std::ostream& out, const Model& model);

// ---- SMV ----
//
// The input language of NuSMV 2 and nuXmv: one MODULE main whose transition relation is total. A
// Mealy machine has an input variable and an output that is defined from state and input. An
// interface automaton has an input variable `action`, one action a step (in_NAME, out_NAME), and
// `idle` in quiescent states.

// DEFINEs say where each input is possible (can_NAME) and where it was never tried
// (unexplored_NAME; absorbed self-loops are such). Throws UsageError for a Mealy machine without
// inputs. O(size).
void write_smv(std::ostream& out, const Model& model);

}  // namespace maide
