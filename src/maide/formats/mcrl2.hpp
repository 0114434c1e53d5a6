// Models as mCRL2 (Groote & Mousavi, "Modeling and Analysis of Communicating Systems", 2014): a
// process for each state, one action a transition. A Mealy machine's transition is the multi-action
// of its input and its output. An input that was never tried is a self-loop `unexplored_NAME`, so
// that it does not look refused.
#pragma once

#include <iosfwd>
#include <span>
#include <string_view>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// As many states and transitions as the model, and a self-loop for each mark.
void write_mcrl2(std::ostream& out, const Model& model);

// Keywords and the names of predefined sorts and functions.
std::span<const std::string_view> mcrl2_reserved();

}  // namespace maide
