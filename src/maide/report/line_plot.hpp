// Plots of lines, as small SVG by hand: how much something grows with something else. Panels stand
// side by side and share their x axis and the names of their lines.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace maide {

enum class PlotScale : std::uint8_t {
  powers_of_two,  // logarithmic, ticks at 1, 2, 4, ...; the values are above 0
  powers_of_ten,  // logarithmic, whole decades; the values are above 0
  linear,         // from 0
};

struct PlotLine {
  std::string name;
  std::vector<std::pair<double, double>> points;
  bool is_staircase = false;  // a value holds until the next point
};

struct PlotPanel {
  std::string title;
  std::vector<PlotLine> lines;  // the same names in the same order in each panel
};

struct PlotAxes {
  std::string x_title;  // below each panel
  PlotScale x = PlotScale::powers_of_two;
  PlotScale y = PlotScale::powers_of_ten;
};

std::string draw_plot(const std::vector<PlotPanel>& panels, const PlotAxes& axes);

}  // namespace maide
