// A plot of how much something grows with N: a panel for each quantity, both axes logarithmic (a
// polynomial is a straight line there), a line for each system. Small SVG by hand.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace maide {

struct PlotLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  // x and y above 0
};

struct PlotPanel {
  std::string title;
  std::vector<PlotLine> lines;  // the same names in the same order in each panel
};

// The panels side by side. `x_title` is below each.
std::string draw_growth(const std::vector<PlotPanel>& panels, const std::string& x_title);

}  // namespace maide
