// The result of a check as one HTML page that needs nothing else: the verdicts, what they rest on,
// and pictures of the models. A counterexample is shown in a sentence, as a message sequence chart,
// step by step, and in the programs' text. Escaped text and listings of programs, which other pages
// use, are here, too.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide {

// Text for HTML and SVG: characters with a meaning there are escaped. Line breaks and tabs stay;
// other control characters become blanks.
std::string escape_markup(std::string_view text);

// ---- Listings ----
//
// The programs' text. Two kinds of lines are marked: those where a program stands when a
// counterexample ends, and those that it repeats for ever.

// Writes a <pre class="program"> for each program, with line numbers. Lines are <mark>s of class
// `waits` or `loops`, or plain. Programs whose source is not known are left out.
void write_program_listing(std::ostream& out, const System& system, const Trace& trace);

// Draws a model as an <svg> element; "" if it cannot be drawn here.
using ModelPainter = std::function<std::string(const InterfaceAutomaton& automaton)>;

void write_html_report(std::ostream& out, const System& system, const CheckReport& report,
                       const ModelPainter& paint);

}  // namespace maide
