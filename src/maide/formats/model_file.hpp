// Models in files. read_model() reads any of them, by the extension of its name (.dot, .gv or
// .aut). Two formats are both read and written: DOT, and Aldebaran's .aut.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

struct ModelReading {
  // The name of the initial state, where the file does not mark it or marks another. ParseError if
  // it has no such state.
  std::string initial;
  // What labels may be: of the two forms alone; anything, as "send(1)" or "tau", where some label
  // is of neither; anything, whatever they look like. What is anything is an input of an interface
  // automaton, and its origin says `labels: opaque`.
  enum class Labels : std::uint8_t { known, any_where_needed, any };
  Labels labels = Labels::known;
};
bool has_opaque_labels(const Model& model);

// Throws UsageError if it is no regular file, cannot be read or has another extension, ParseError
// for its text.
Model read_model(const std::filesystem::path& path, const ModelReading& reading = {});
// As above; a model of the other kind is a UsageError that names the file.
Mealy read_mealy(const std::filesystem::path& path);
// The model as a Mealy machine, complete and deterministic; `path` is for the UsageError.
Mealy take_mealy(Model model, const std::filesystem::path& path);
InterfaceAutomaton read_interface_automaton(const std::filesystem::path& path);

// "Mealy machine", "partial Mealy machine", "interface automaton", ...
std::string_view name_of_kind(const Model& model);

// For the readers below. The initial state that was asked for, if one was; throws ParseError if
// there is no such state. Whether labels are anything.
void set_initial(const ModelReading& reading, LabelledGraph& graph);
void note_labels(const ModelReading& reading, LabelledGraph& graph);

// ---- DOT ----
//
// A Mealy machine has the form of the Automata Wiki (Neider, Smetsers, Vaandrager, Kuppens,
// "Benchmarks for automata learning and conformance testing", 2019): `s0 -> s1 [label="input /
// output"];`. An interface automaton labels inputs ?a and outputs !a. Graph attributes carry the
// rest: `inputs`, `outputs` (also those never seen), `actors`, `hidden_returns`, and the model's
// origin under its own keys. The node attribute `unexplored` and the edge attribute `absorbed`
// carry an interface automaton's marks.

// Reads either kind; which one it is, is seen from the labels (or the graph attribute `type`,
// written where they would mislead). `file` is for messages. Throws ParseError (file:line:column).
// A model that write_dot wrote is read as it was, numbers of states and symbols included.
//
// Several things may mark the initial state. The first of these counts:
// 1. A node `__start0` leads to it. So may any node with one edge, which has no label, and with no
//    edge to it.
// 2. The graph attribute `initial` names it.
// 3. It alone has a node attribute `initial`, `init`, `start` or `root` that is not "false".
// 4. It alone has a double circle, in a graph that is no DFA.
// 5. It is mentioned first.
Model read_dot(std::string_view text, const std::string& file, const ModelReading& reading = {});

// The model's file; `dot` draws it. Byte for byte the same for equal models.
void write_dot(std::ostream& out, const Mealy& machine);
void write_dot(std::ostream& out, const NondeterministicMealy& machine);
void write_dot(std::ostream& out, const InterfaceAutomaton& automaton);
void write_dot(std::ostream& out, const Model& model);

// The states and transitions of a Mealy machine alone, as tools read them that know no graph
// attributes (LearnLib's and AALpy's readers). The machine is the same; its origin and strength,
// and what a Moore machine says before the first input, are left out. Throws UsageError for an
// interface automaton.
void write_automata_wiki(std::ostream& out, const Model& model);

// ---- Aldebaran ----
//
// The format .aut of CADP, mCRL2 and LTSmin: a first line `des (initial, transitions, states)`,
// then a line `(from, "label", to)` for each transition, with the labels of DOT files. It has no
// place for alphabets, origin and actors, nor for the marks that tell "refused" from "never tried".

// Throws ParseError (file:line:column); a file may promise at most a million states more than its
// transitions touch. O(text).
Model read_aut(std::string_view text, const std::string& file, const ModelReading& reading = {});

enum class MarkLoss : bool { refuse, accept };

// The format has no place for an interface automaton's unexplored inputs, absorbed edges and hidden
// returns, nor for the output of a Moore machine before its first input. Throws UsageError for a
// model that has any of these, unless their loss is accepted. Then unexplored inputs look refused,
// and absorbed edges look tried.
void write_aut(std::ostream& out, const Model& model, MarkLoss marks = MarkLoss::refuse);

// Which marks a model has, for messages: "unexplored inputs, absorbed edges"; empty for none.
std::string marks_of(const Model& model);

}  // namespace maide
