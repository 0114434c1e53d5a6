#include "maide/report/sequence_chart.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace maide {
namespace {

std::string draw(const SequenceChart& chart, std::size_t most = 200) {
  std::ostringstream out;
  write_sequence_chart_svg(out, chart, most);
  return out.str();
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

SequenceChart two_lanes(std::size_t messages) {
  SequenceChart chart;
  chart.lanes = {{"planner", false}, {"via <1>", true}};
  for (std::size_t i = 0; i < messages; ++i)
    chart.messages.push_back({0, 1, "write", "line 8", "", ""});
  return chart;
}

TEST(SequenceChart, DrawsEveryLaneAndMessage) {
  SequenceChart chart = two_lanes(3);
  chart.notes = {{0, "waits"}};
  const std::string svg = draw(chart);
  EXPECT_EQ(count(svg, "marker-end"), 3U);
  EXPECT_EQ(count(svg, "via &lt;1&gt;"), 1U);
  EXPECT_EQ(count(svg, ">line 8<"), 3U);
  EXPECT_EQ(count(svg, ">waits<"), 1U);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

TEST(SequenceChart, FoldsRepetitionsAndSaysSo) {
  const std::string svg = draw(two_lanes(1000), 10);
  EXPECT_EQ(count(svg, "marker-end"), 1U);
  EXPECT_EQ(count(svg, "step 1 again, 999 times, to step 1000"), 1U);
}

TEST(SequenceChart, LeavesOutTheMiddleOfLongRunsAndSaysSo) {
  SequenceChart chart = two_lanes(1000);
  for (std::size_t i = 0; i < 1000; ++i) chart.messages[i].label = std::to_string(i);
  const std::string svg = draw(chart, 10);
  EXPECT_EQ(count(svg, "marker-end"), 9U);
  EXPECT_EQ(count(svg, "steps 6 to 996 not shown"), 1U);
}

TEST(SequenceChart, MarksTheLoop) {
  SequenceChart chart = two_lanes(4);
  chart.loop_start = 2;
  EXPECT_EQ(count(draw(chart), "repeats for ever"), 1U);
  EXPECT_EQ(count(draw(two_lanes(4)), "repeats for ever"), 0U);
}

}  // namespace
}  // namespace maide
