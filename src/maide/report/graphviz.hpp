// Pictures of graphs: Graphviz's `dot` run on a text.
#pragma once

#include <string>

#include "maide/base/run_control.hpp"

namespace maide {

// Whether `dot` is on PATH.
bool can_draw();

// The picture of a graph in DOT as an <svg> element; "" if `dot` is not there, fails, or takes more
// than 20 seconds. Throws Interrupted.
std::string draw_svg(const std::string& dot, const RunControl& control);

}  // namespace maide
