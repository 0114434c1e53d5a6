// Models in Aldebaran's format .aut (CADP, mCRL2, LTSmin): a first line `des (initial, transitions,
// states)`, then a line `(from, "label", to)` for each transition, with the labels of DOT files. It
// knows nothing of alphabets, origin and actors, nor of the marks that tell "refused" from "never
// tried".
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// Throws ParseError (file:line:column); a file may promise at most a million states more than its
// transitions touch. O(text).
Model read_aut(std::string_view text, const std::string& file);

enum class MarkLoss : bool { refuse, accept };

// An interface automaton's unexplored inputs, absorbed edges and hidden returns cannot be written,
// nor the output of a Moore machine before its first input: throws UsageError for a model that has
// any, unless their loss is accepted. Unexplored inputs then look refused, absorbed edges look
// tried.
void write_aut(std::ostream& out, const Model& model, MarkLoss marks = MarkLoss::refuse);

// Which marks a model has, for messages: "unexplored inputs, absorbed edges"; empty for none.
std::string marks_of(const Model& model);

}  // namespace maide
