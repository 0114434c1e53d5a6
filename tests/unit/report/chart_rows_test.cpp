// The rows of a sequence chart.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide {
namespace {

// A chart whose messages are the letters.
SequenceChart chart_of(const std::string& letters) {
  SequenceChart chart;
  chart.lanes = {{"a", false}, {"b", true}};
  for (const char letter : letters) chart.messages.push_back({0, 1, {letter}, "", "", ""});
  return chart;
}

std::string show(const SequenceChart& chart, std::size_t most = 200) {
  std::string text;
  for (const ChartRow& row : fold_chart(chart, most)) {
    text += row.remark.empty() ? chart.messages[row.message].label : " [" + row.remark + "] ";
  }
  return text;
}

TEST(ChartRows, ShortRunsStayAsTheyAre) {
  EXPECT_EQ(show(chart_of("")), "");
  EXPECT_EQ(show(chart_of("abcab")), "abcab");
  EXPECT_EQ(show(chart_of("aaab")), "aaab");
}

TEST(ChartRows, RepetitionsAreShownOnce) {
  EXPECT_EQ(show(chart_of("aaaaaab")), "a [step 1 again, 5 times, to step 6] b");
  EXPECT_EQ(show(chart_of("xabababab")), "xab [steps 2 to 3 again, 3 times, to step 9] ");
}

TEST(ChartRows, FoldsLieWithinFolds) {
  std::string letters;
  for (int i = 0; i < 10; ++i) letters += "aaaaaabbbbbb";
  EXPECT_EQ(show(chart_of(letters)),
            "a [step 1 again, 5 times, to step 6] b [step 7 again, 5 times, to step 12]  "
            "[steps 1 to 12 again, 9 times, to step 120] ");
}

TEST(ChartRows, WhatDiffersInARemarkIsNotFolded) {
  SequenceChart chart = chart_of("aaaaaaaa");
  chart.messages[3].remark = "lost";
  EXPECT_EQ(show(chart), "aaaaa [step 5 again, 3 times, to step 8] ");
}

// A number that counts on is told where the fold ends; one that jumps is not folded.
TEST(ChartRows, NumbersThatCountOnAreFolded) {
  SequenceChart chart = chart_of("ababababab");
  for (std::size_t i = 0; i < chart.messages.size(); i += 2) {
    chart.messages[i].remark = "n = " + std::to_string(i / 2);
    chart.messages[i].counted = "n + 1";
  }
  EXPECT_EQ(show(chart), "ab [steps 1 to 2 again, 4 times, to step 10: n = 4] ");
  chart.messages[4].counted = "n + 2";
  EXPECT_EQ(show(chart), "ababababab");
}

TEST(ChartRows, TheLoopBeginsARowOfItsOwn) {
  SequenceChart chart = chart_of("aaaaaaaaaa");
  chart.loop_start = 5;
  EXPECT_EQ(show(chart),
            "a [step 1 again, 4 times, to step 5] a [step 6 again, 4 times, to step 10] ");
}

TEST(ChartRows, TooManyRowsLoseTheirMiddle) {
  SequenceChart chart = chart_of("abcdefghijklmnopqrstuvwxyz");
  EXPECT_EQ(show(chart, 6), "abc [steps 4 to 24 not shown] yz");
  chart.loop_start = 10;
  EXPECT_EQ(show(chart, 6), "abc [steps 4 to 24 not shown; the loop begins at step 11] yz");
}

// Reading the rows back, each remark doing what it says, gives the chart again.
TEST(ChartRows, NothingIsHidden) {
  Random random(77);
  for (int round = 0; round < 500; ++round) {
    std::string letters;
    while (letters.size() < 60) {
      std::string part;
      for (std::uint64_t i = random.between(1, 4); i > 0; --i) {
        part += static_cast<char>('a' + random.below(2));
      }
      for (std::uint64_t i = random.between(1, 6); i > 0; --i) letters += part;
    }
    const SequenceChart chart = chart_of(letters);
    std::string unfolded;
    for (const ChartRow& row : fold_chart(chart)) {
      if (row.remark.empty()) {
        ASSERT_EQ(row.message, unfolded.size()) << letters;
        unfolded += chart.messages[row.message].label;
        continue;
      }
      std::size_t begin = 0, end = 0, times = 0, to = 0;
      const char* text = row.remark.c_str();
      if (std::sscanf(text, "steps %zu to %zu again, %zu times, to step %zu", &begin, &end, &times,
                      &to) != 4) {
        ASSERT_EQ(std::sscanf(text, "step %zu again, %zu times, to step %zu", &begin, &times, &to),
                  3);
        end = begin;
      }
      ASSERT_EQ(end, unfolded.size()) << letters;
      const std::string part = unfolded.substr(begin - 1);
      for (std::size_t i = 0; i < times; ++i) unfolded += part;
      ASSERT_EQ(to, unfolded.size()) << letters;
    }
    EXPECT_EQ(unfolded, letters);
  }
}

}  // namespace
}  // namespace maide
