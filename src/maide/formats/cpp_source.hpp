// Models as C++: one header with a state machine class that needs nothing of Maide and nothing but
// the standard library; transitions are tables. For a Mealy machine `Output step(Input)`; for an
// interface automaton inputs that are given (can, input) and outputs that are taken (is_due, take),
// where "refused" and "never tried" stay different (try_input).
#pragma once

#include <iosfwd>
#include <string>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// `class_name` becomes an identifier. Throws UsageError for a nondeterministic interface automaton:
// a class has one next state. O(states x symbols).
void write_cpp(std::ostream& out, const Model& model, const std::string& class_name);

}  // namespace maide
