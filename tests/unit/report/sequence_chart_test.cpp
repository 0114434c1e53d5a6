#include "maide/report/sequence_chart.hpp"

#include <gtest/gtest.h>

#include <optional>
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

// The writer sends with the first message what arrives, is lost, or goes on.
SequenceChart sent_at_first(std::optional<std::size_t> ended, bool is_lost) {
  SequenceChart chart;
  chart.lanes = {{"planner", false}, {"via", true}};
  chart.messages = {{0, 0, "write", "", "", ""}, {0, 0, "work", "", "", ""}};
  if (ended) chart.messages.push_back({0, 1, "via!arrives", "", "", "sent at step 1"});
  chart.passages = {{0, 1, 0, ended, is_lost}};
  return chart;
}

TEST(SequenceChart, DrawsWhatArrivesLaterFromItsSendingToItsArrival) {
  const std::string svg = draw(sent_at_first(2, false));
  EXPECT_EQ(count(svg, R"(<line x1="192" y1="70" x2="356" y2="122" )"), 1U);
  EXPECT_EQ(count(svg, "marker-end"), 1U);
  EXPECT_EQ(count(svg, ">sent at step 1<"), 1U);
  EXPECT_EQ(count(svg, ">via!arrives<"), 0U);  // the line says it
}

TEST(SequenceChart, EndsWhatIsLostInACrossAndWhatIsOnItsWayNowhere) {
  const std::string lost = draw(sent_at_first(2, true)), open = draw(sent_at_first({}, false));
  EXPECT_EQ(count(lost, "marker-end"), 0U);
  EXPECT_EQ(count(lost, "l8,8 m0,-8 l-8,8"), 1U);
  EXPECT_EQ(count(open, "marker-end"), 0U);
  EXPECT_EQ(count(open, "l8,8 m0,-8 l-8,8"), 0U);
  EXPECT_EQ(count(open, R"(x2="301" )"), 1U);  // two thirds of the way
}

TEST(SequenceChart, DrawsTheEndOfWhatWasSentInARowThatIsNotShown) {
  SequenceChart chart = sent_at_first(20, false);
  chart.messages.resize(2);
  for (int i = 2; i < 20; ++i) chart.messages.push_back({0, 0, std::to_string(i), "", "", ""});
  chart.messages.push_back({0, 1, "via!arrives", "", "", "sent at step 3"});
  chart.passages[0].sent = 2;
  const std::string svg = draw(chart, 4);
  EXPECT_EQ(count(svg, "marker-end"), 1U);
  EXPECT_EQ(count(svg, R"(<line x1="192" y1="122" x2="356" y2="148" )"), 1U);
}

TEST(SequenceChart, MarksTheLoop) {
  SequenceChart chart = two_lanes(4);
  chart.loop_start = 2;
  EXPECT_EQ(count(draw(chart), "repeats for ever"), 1U);
  EXPECT_EQ(count(draw(two_lanes(4)), "repeats for ever"), 0U);
}

}  // namespace
}  // namespace maide
