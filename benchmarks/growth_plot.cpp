#include "growth_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "maide/report/markup.hpp"

namespace maide {
namespace {

constexpr double panel_width = 420, panel_height = 320;
constexpr double left = 60, right = 15, top = 30, bottom = 45, legend_line = 18;
constexpr std::array colours = {"#1f6fb4", "#d1651a", "#2c8f4e", "#8a4fb0", "#b03a48", "#6b6b6b"};
constexpr std::array dashes = {"none", "6 3", "2 3", "8 3 2 3"};

struct Range {
  double low, high;  // logarithms
  double place(double value) const { return (std::log10(value) - low) / (high - low); }
};

// Of x or y, over all lines; y to whole powers of ten.
Range find_range(const PlotPanel& panel, double std::pair<double, double>::*axis, bool rounds) {
  Range range{1e9, -1e9};
  for (const PlotLine& line : panel.lines) {
    for (const auto& point : line.points) {
      range.low = std::min(range.low, std::log10(point.*axis));
      range.high = std::max(range.high, std::log10(point.*axis));
    }
  }
  if (range.low > range.high) return {0, 1};
  if (rounds) range = {std::floor(range.low), std::ceil(range.high)};
  if (range.high - range.low < 1e-9) range.high = range.low + 1;
  return range;
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

std::string draw_panel(const PlotPanel& panel, const std::string& x_title, double origin) {
  const Range xs = find_range(panel, &std::pair<double, double>::first, false);
  const Range ys = find_range(panel, &std::pair<double, double>::second, true);
  const double width = panel_width - left - right, height = panel_height - top - bottom;
  const auto at_x = [&](double x) { return origin + left + xs.place(x) * width; };
  const auto at_y = [&](double y) { return top + (1 - ys.place(y)) * height; };
  std::string svg = text(origin + left + width / 2, 18, "middle", panel.title);
  for (double power = ys.low; power <= ys.high; ++power) {
    const double y = at_y(std::pow(10, power));
    svg += rule(origin + left, y, origin + left + width, y);
    svg += text(origin + left - 6, y + 4, "end", fmt::format("{:g}", std::pow(10, power)));
  }
  for (double x = 1; std::log10(x) <= xs.high + 1e-9; x *= 2) {
    if (std::log10(x) < xs.low - 1e-9) continue;
    svg += rule(at_x(x), top, at_x(x), top + height);
    svg += text(at_x(x), top + height + 16, "middle", fmt::format("{:g}", x));
  }
  svg += text(origin + left + width / 2, top + height + 34, "middle", x_title);
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    std::string path;
    for (const auto& [x, y] : panel.lines[i].points) {
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', at_x(x), at_y(y));
    }
    svg += fmt::format(R"(<path class="line" stroke="{}" stroke-dasharray="{}" d="{}"/>)"
                       "\n",
                       colours[i % colours.size()], dashes[i % dashes.size()], path);
  }
  return svg;
}

}  // namespace

std::string draw_growth(const std::vector<PlotPanel>& panels, const std::string& x_title) {
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
    svg += draw_panel(panels[i], x_title, panel_width * static_cast<double>(i));
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
