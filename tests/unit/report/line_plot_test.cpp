#include "maide/report/line_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace maide {
namespace {

using testing::HasSubstr;
using testing::Not;

// The labels of the ticks of the axis whose texts are anchored so.
std::vector<std::string> labels(const std::string& svg, const std::string& anchor) {
  std::vector<std::string> result;
  const std::string mark = "text-anchor=\"" + anchor + "\">";
  for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1)) {
    const std::size_t start = at + mark.size();
    result.push_back(svg.substr(start, svg.find('<', start) - start));
  }
  return result;
}

std::string plot(PlotScale x, PlotScale y, std::vector<std::pair<double, double>> points) {
  return draw_plot({{"title", {{"line", std::move(points)}}}}, {"below", x, y});
}

TEST(LinePlot, PutsTicksWhereTheScaleHasThem) {
  const std::string growth =
      plot(PlotScale::powers_of_two, PlotScale::powers_of_ten, {{3, 20}, {16, 700}});
  EXPECT_EQ(labels(growth, "end"), (std::vector<std::string>{"10", "100", "1000"}));
  EXPECT_EQ(labels(growth, "middle"), (std::vector<std::string>{"title", "4", "8", "16", "below"}));
  const std::string states = plot(PlotScale::powers_of_ten, PlotScale::linear, {{5, 1}, {800, 31}});
  EXPECT_EQ(labels(states, "end"), (std::vector<std::string>{"0", "10", "20", "30"}));
  EXPECT_EQ(labels(states, "middle"),
            (std::vector<std::string>{"title", "1", "10", "100", "1000", "below"}));
}

TEST(LinePlot, LinearTicksAreFewForEverySize) {
  for (const double high : {1.0, 3.0, 7.0, 17.0, 99.0, 3410.0, 1e6}) {
    const auto ticks =
        labels(plot(PlotScale::powers_of_ten, PlotScale::linear, {{1, high}}), "end");
    EXPECT_GE(ticks.size(), 3U) << high;
    EXPECT_LE(ticks.size(), 8U) << high;
    EXPECT_EQ(ticks.front(), "0");
  }
}

// A level stretch to the next point's x, then straight up.
TEST(LinePlot, AStaircaseHoldsItsValueUntilTheNextPoint) {
  PlotLine line{"line", {{1, 1}, {10, 2}}, true};
  const PlotAxes axes{"x", PlotScale::powers_of_ten, PlotScale::linear};
  EXPECT_THAT(draw_plot({{"", {line}}}, axes), HasSubstr("d=\"M60.0 152.5H395.0L395.0 30.0\""));
  line.is_staircase = false;
  EXPECT_THAT(draw_plot({{"", {line}}}, axes), HasSubstr("d=\"M60.0 152.5L395.0 30.0\""));
}

TEST(LinePlot, NamesAreEscapedAndNothingIsAPlotToo) {
  EXPECT_THAT(draw_plot({{"a<b", {{"c&d", {}}}}}, {"x"}), HasSubstr("a&lt;b"));
  const std::string empty = draw_plot({}, {"x"});
  EXPECT_THAT(empty, HasSubstr("</svg>"));
  EXPECT_THAT(empty, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace maide
