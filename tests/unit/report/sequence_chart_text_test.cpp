// Charts for the terminal.
#include <gtest/gtest.h>

#include <sstream>

#include "maide/base/text.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {
namespace {

SequenceChart burst() {
  SequenceChart chart;
  chart.lanes = {{"planner", false}, {"via", true}, {"controller", false}};
  chart.messages.push_back({0, 1, "write", "line 8", "repeat 6 { via.write; }", ""});
  for (int i = 0; i < 5; ++i) {
    chart.messages.push_back({0, 1, "write", "line 8", "repeat 6 { via.write; }", "one is lost"});
  }
  chart.messages.push_back({2, 1, "read", "line 13", "via.read -> message;", ""});
  chart.messages.push_back({1, 2, "message", "line 13", "via.read -> message;", ""});
  chart.messages.push_back({2, 0, "far", "", "", ""});
  chart.messages.push_back({0, 0, "if", "line 9", "", ""});
  return chart;
}

std::string draw(const SequenceChart& chart, const ChartTextStyle& style = {}) {
  std::ostringstream out;
  write_sequence_chart_text(out, chart, style);
  return "\n" + out.str();
}

TEST(SequenceChartText, IsPlainAscii) {
  EXPECT_EQ(draw(burst()), R"(
      planner      via      controller
   1     |- write ->|            |       line 8  repeat 6 { via.write; }
   2     |- write ->|            |       (one is lost)  line 8  repeat 6 { via.write; }
  ... step 2 again, 4 times, to step 6 ...
   7     |          |<---- read -|       line 13  via.read -> message;
   8     |          |- message ->|       line 13  via.read -> message;
   9     |<---------+------ far -|
  10     * if       |            |       line 9
)");
}

TEST(SequenceChartText, DotsWhatWasSentBeforeAndCrossesWhatIsLost) {
  SequenceChart chart;
  chart.lanes = {{"planner", false}, {"via", true}};
  chart.messages = {{0, 0, "write", "line 8", "", ""},
                    {0, 1, "arrives", "", "", "sent at step 1"},
                    {0, 1, "lost", "", "", ""}};
  chart.passages = {{0, 1, 0, 1, false}, {0, 1, 0, 2, true}};
  EXPECT_EQ(draw(chart), R"(
     planner        via
  1     * write      |    line 8
  2     |. arrives .>|    (sent at step 1)
  3     |. lost ....x|
)");
  EXPECT_EQ(draw(chart, {.width = 60, .unicode = true}), R"(
     planner        via
  1     • write      │    line 8
  2     │╌ arrives ╌→│    (sent at step 1)
  3     │╌ lost ╌╌╌╌×│
)");
}

TEST(SequenceChartText, DrawsLinesInUtf8AndBracketsTheLoop) {
  SequenceChart chart = burst();
  chart.loop_start = 6;
  EXPECT_EQ(draw(chart, {.width = 60, .unicode = true}), R"(
      planner      via      controller
   1     │─ write ─→│            │       line 8  repeat 6 {…
   2     │─ write ─→│            │       (one is lost)  lin…
  ... step 2 again, 4 times, to step 6 ...
┌  7     │          │←──── read ─│       line 13  via.read …
│  8     │          │─ message ─→│       line 13  via.read …
│  9     │←─────────┼────── far ─│
│ 10     • if       │            │       line 9
└─ repeats for ever
)");
}

TEST(SequenceChartText, KnowsWhatFits) {
  const SequenceChart chart = burst();
  EXPECT_TRUE(fits_as_text(chart, {.width = 60}));
  EXPECT_FALSE(fits_as_text(chart, {.width = 30}));
}

TEST(TerminalText, KeepsUtf8AndMarksWhatIsNone) {
  EXPECT_EQ(to_characters("zwölf€😀").size(), 7U);
  EXPECT_EQ(to_utf8(to_characters("zwölf€😀")), "zwölf€😀");
  EXPECT_EQ(to_utf8(to_characters("a\xff\tb\xc3")), "a??b?");
  EXPECT_EQ(to_utf8(to_characters("\xed\xa0\x80 \xc0\xaf")), "??? ??");  // a surrogate, overlong
  EXPECT_EQ(to_utf8(clip(to_characters("controller"), 6, false)), "con...");
  EXPECT_EQ(to_utf8(clip(to_characters("controller"), 6, true)), "contr…");
  EXPECT_EQ(to_utf8(clip(to_characters("controller"), 2, false)), "co");
}

TEST(TerminalText, WrapsAtWords) {
  EXPECT_EQ(wrap("one two three  four", 10, 2), "  one two\n  three\n  four\n");
  EXPECT_EQ(wrap("zwölf zwölf", 11, 0), "zwölf zwölf\n");
  EXPECT_EQ(wrap("longer-than-that x", 5, 1), " longer-than-that\n x\n");
  EXPECT_EQ(wrap("", 5, 1), "");
}

}  // namespace
}  // namespace maide
