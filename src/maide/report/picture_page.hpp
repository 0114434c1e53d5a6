// Pages of `maide view`: a model, a system or a chart as one HTML file that needs nothing else, in
// light and dark.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "maide/check/system/system.hpp"
#include "maide/formats/labelled_graph.hpp"

namespace maide {

// Draws a graph in DOT as an <svg> element; "" if that is not possible here.
using GraphPainter = std::function<std::string(const std::string& dot)>;

// ---- Parts of pages ----
//
// The frame with the title as its heading; `style` stands behind the style sheet that all pages
// have.
void open_page(std::ostream& out, const std::string& title, const std::string& style = "");
void close_page(std::ostream& out);

// ---- Pages ----

// The picture, what it means, what is known of the model; a table where it is too large to draw.
void write_model_page(std::ostream& out, const Model& model, const std::string& title,
                      const GraphPainter& paint);
// How programs and models are connected, each of them, and the text of the file with its lines.
void write_system_page(std::ostream& out, const System& system, const std::string& text,
                       const GraphPainter& paint);
// One picture, an <svg> element, with its title.
void write_chart_page(std::ostream& out, const std::string& svg, const std::string& title);

// A picture as a file of its own: with the style sheet and a background.
std::string stand_alone(const std::string& svg);

}  // namespace maide
