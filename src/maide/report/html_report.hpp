// A check's result as one HTML page that needs nothing else: verdicts, what they rest on, each
// counterexample in a sentence, as a message sequence chart, step by step and in the programs'
// text, and pictures of the models.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "maide/check/check_system.hpp"

namespace maide {

// Draws a model as an <svg> element; "" if it cannot be drawn here.
using ModelPainter = std::function<std::string(const InterfaceAutomaton& automaton)>;

void write_html_report(std::ostream& out, const System& system, const CheckReport& report,
                       const ModelPainter& paint);

}  // namespace maide
