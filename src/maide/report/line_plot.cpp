#include "maide/report/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "maide/report/html_report.hpp"

namespace maide {
namespace {

constexpr double panel_width = 420, panel_height = 320;
constexpr double left = 60, right = 25, top = 30, bottom = 45, legend_line = 18;
constexpr std::array colours = {"#1f6fb4", "#d1651a", "#2c8f4e", "#8a4fb0", "#b03a48", "#6b6b6b"};
constexpr std::array dashes = {"none", "6 3", "2 3", "8 3 2 3"};

// An axis: from where to where, and where its ticks are. `low` and `high` are logarithms, or values
// of a linear axis.
struct Axis {
  PlotScale scale;
  double low, high;

  double position(double value) const {
    return scale == PlotScale::linear ? value : std::log10(value);
  }
  double place(double value) const { return (position(value) - low) / (high - low); }

  std::vector<double> ticks() const {
    std::vector<double> result;
    if (scale == PlotScale::linear) {
      // At most some six steps of 1, 2 or 5 times a power of ten.
      const double power = std::pow(10, std::floor(std::log10(high / 6)));
      double step = 10 * power;
      for (const double factor : {1.0, 2.0, 5.0}) {
        if (step > factor * power && high <= 6.0001 * factor * power) step = factor * power;
      }
      for (int i = 0; i * step <= high * 1.0001; ++i) result.push_back(i * step);
      return result;
    }
    const double base = scale == PlotScale::powers_of_two ? 2 : 10;
    double tick = std::pow(base, std::ceil(low / std::log10(base) - 1e-9));
    while (std::log10(tick) <= high + 1e-9) {
      result.push_back(tick);
      tick *= base;
    }
    return result;
  }
};

// The axis of x or y that holds all lines.
Axis find_axis(const PlotPanel& panel, double std::pair<double, double>::*coordinate,
               PlotScale scale) {
  Axis axis{scale, 1e300, -1e300};
  for (const PlotLine& line : panel.lines) {
    for (const auto& point : line.points) {
      axis.low = std::min(axis.low, axis.position(point.*coordinate));
      axis.high = std::max(axis.high, axis.position(point.*coordinate));
    }
  }
  if (axis.low > axis.high) axis.low = axis.high = 0;
  if (scale == PlotScale::linear) axis.low = 0;
  if (scale == PlotScale::powers_of_ten) {
    axis.low = std::floor(axis.low);
    axis.high = std::ceil(axis.high);
  }
  if (axis.high - axis.low < 1e-9) axis.high = axis.low + 1;
  return axis;
}

std::string text(double x, double y, const char* anchor, std::string_view content) {
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)"
                     "\n",
                     x, y, anchor, escape_markup(content));
}

std::string rule(double x1, double y1, double x2, double y2) {
  return fmt::format(R"(<path class="rule" d="M{:.1f} {:.1f}L{:.1f} {:.1f}"/>)"
                     "\n",
                     x1, y1, x2, y2);
}

std::string draw_panel(const PlotPanel& panel, const PlotAxes& axes, double origin) {
  const Axis xs = find_axis(panel, &std::pair<double, double>::first, axes.x);
  const Axis ys = find_axis(panel, &std::pair<double, double>::second, axes.y);
  const double width = panel_width - left - right, height = panel_height - top - bottom;
  const auto at_x = [&](double x) { return origin + left + xs.place(x) * width; };
  const auto at_y = [&](double y) { return top + (1 - ys.place(y)) * height; };
  std::string svg = text(origin + left + width / 2, 18, "middle", panel.title);
  for (const double tick : ys.ticks()) {
    const double y = at_y(tick);
    svg += rule(origin + left, y, origin + left + width, y);
    svg += text(origin + left - 6, y + 4, "end", fmt::format("{:g}", tick));
  }
  for (const double tick : xs.ticks()) {
    svg += rule(at_x(tick), top, at_x(tick), top + height);
    svg += text(at_x(tick), top + height + 16, "middle", fmt::format("{:g}", tick));
  }
  svg += text(origin + left + width / 2, top + height + 34, "middle", axes.x_title);
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    std::string path;
    for (const auto& [x, y] : panel.lines[i].points) {
      if (panel.lines[i].is_staircase && !path.empty()) path += fmt::format("H{:.1f}", at_x(x));
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', at_x(x), at_y(y));
    }
    svg += fmt::format(R"(<path class="line" stroke="{}" stroke-dasharray="{}" d="{}"/>)"
                       "\n",
                       colours[i % colours.size()], dashes[i % dashes.size()], path);
  }
  return svg;
}

}  // namespace

std::string draw_plot(const std::vector<PlotPanel>& panels, const PlotAxes& axes) {
  const std::size_t lines = panels.empty() ? 0 : panels.front().lines.size();
  const double width = panel_width * static_cast<double>(panels.size());
  const double height = panel_height + legend_line * static_cast<double>(lines) + 6;
  std::string svg = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:.0f} {1:.0f}" width="{0:.0f}" height="{1:.0f}">
<style>text{{font:12px sans-serif;fill:#222}}.rule{{stroke:#ddd;fill:none}}.line{{stroke-width:2;fill:none}}</style>
<rect width="{0:.0f}" height="{1:.0f}" fill="#fff"/>
)",
      width, height);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    svg += draw_panel(panels[i], axes, panel_width * static_cast<double>(i));
  }
  for (std::size_t i = 0; i < lines; ++i) {
    const double y = panel_height + legend_line * static_cast<double>(i) + 8;
    svg += fmt::format(R"(<path class="line" stroke="{}" stroke-dasharray="{}" d="M{} {}h40"/>)"
                       "\n",
                       colours[i % colours.size()], dashes[i % dashes.size()], left, y - 4);
    svg += text(left + 50, y, "start", panels.front().lines[i].name);
  }
  return svg + "</svg>\n";
}

}  // namespace maide
