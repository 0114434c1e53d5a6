// Models, programs and connections as graphs for people, in DOT, and Graphviz's `dot`, which draws
// them. Parallel edges are one edge with several lines. What was never tried stands beside its
// state. Every node and edge has a class, by which a page colours it (picture_style()). These
// graphs are not for reading back: formats/model_file.hpp writes models for that.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/system/system.hpp"
#include "maide/formats/labelled_graph.hpp"

namespace maide {

// ---- Drawing ----

// Whether `dot` is on PATH.
bool can_draw();

// The picture of a graph in DOT as an <svg> element; "" if `dot` is not there, fails, or takes more
// than 20 seconds. Throws Interrupted.
std::string draw_svg(const std::string& dot, const RunControl& control);

// Draws the graph as a tikzpicture, for LaTeX: the classes of nodes and edges are its styles.
std::string draw_tikz(const std::string& dot, const RunControl& control);

// ---- Graphs ----
//
// A larger graph is shown as a table: nobody sees anything in the picture, and `dot` takes minutes.
inline constexpr std::size_t most_drawn_states = 150;
inline constexpr std::size_t most_drawn_transitions = 600;

struct PictureSize {
  std::size_t states = 0, transitions = 0;
  bool is_drawable() const {
    return states <= most_drawn_states && transitions <= most_drawn_transitions;
  }
};

PictureSize size_of(const Model& model);
PictureSize size_of(const Program& program);

// A state in which an output is due is filled, one with inputs that were never tried has a dashed
// arrow for them.
std::string model_picture(const Model& model);
// A program's automaton: control states with their labels, steps with their lines in the file.
std::string program_picture(const System& system, const Program& program);
// Which program gives which inputs to which model, and takes which outputs.
std::string connection_picture(const System& system);

// ---- Two machines in one graph ----

struct JointPicture {
  struct State {
    std::string name;
    std::string kind;    // the class: "both", "left", "right"
    std::string remark;  // a line of its own below the name; or ""
  };
  struct Step {
    std::size_t from = 0, to = 0;
    std::string kind;  // likewise, and "plain", "failed"
    std::string label;
  };
  std::vector<State> states;
  std::vector<Step> steps;
  std::vector<std::size_t> starts;  // states, each with its kind in `start_kinds`
  std::vector<std::string> start_kinds;
};

// In DOT. State i has the id "n<i>". Steps of one kind between the same states are one edge; the
// number of each step's edge is put into `edges`, and edge i has the id "e<i>". States and steps
// that `is_shown` (by state) leaves out are not drawn; the number of an edge that is not there is
// that of no edge, `steps.size()`.
std::string joint_picture(const JointPicture& picture, const std::vector<bool>& is_shown,
                          std::vector<std::size_t>& edges);

// A style sheet for these pictures, for light and dark pages; to go inside <style>.
std::string picture_style();

}  // namespace maide
