// Models as Graphviz DOT. A Mealy machine is in the form of the Automata Wiki (Neider, Smetsers,
// Vaandrager, Kuppens, "Benchmarks for automata learning and conformance testing", 2019):
// `s0 -> s1 [label="input / output"];`; an interface automaton labels inputs ?a and outputs !a.
// Graph attributes carry the rest: `inputs`, `outputs` (also those never seen), `actors`,
// `hidden_returns`, and the model's origin under its own keys; the node attribute `unexplored` and
// the edge attribute `absorbed` carry an interface automaton's marks.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// Reads either kind; which one it is, is seen from the labels (or the graph attribute `type`,
// written where they would mislead). The initial state is the target of `__start0`, or else the
// first node mentioned. `file` is for messages. Throws ParseError (file:line:column). A model that
// write_dot wrote is read as it was, numbers of states and symbols included.
Model read_dot(std::string_view text, const std::string& file);

// The model's file; `dot` draws it. Byte for byte the same for equal models.
void write_dot(std::ostream& out, const Mealy& machine);
void write_dot(std::ostream& out, const NondeterministicMealy& machine);
void write_dot(std::ostream& out, const InterfaceAutomaton& automaton);
void write_dot(std::ostream& out, const Model& model);

}  // namespace maide
