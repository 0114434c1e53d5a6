// What a terminal may be given of a text that others wrote.
#include <gtest/gtest.h>

#include <string>

#include "maide/base/text.hpp"

namespace maide {
namespace {

TEST(Printable, KeepsTextLinesAndTabs) {
  const std::string text = "two lines\n\tof text: \u00e4\u00df \u20ac \U0001f916 ~\n";
  EXPECT_EQ(printable(text), text);
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, LeavesNoControlCharacter) {
  EXPECT_EQ(printable("\x1b[2J\x1b]0;title\x07"), "?[2J?]0;title?");
  EXPECT_EQ(printable("over\rwritten\b\x7f"), "over?written??");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(printable("\u009b31mred\u0085\u00a0"), "?31mred?\u00a0");  // CSI, NEL; a blank
}

TEST(Printable, LeavesNoByteThatIsNotUtf8) {
  EXPECT_EQ(printable("\x9b"
                      "31m\xff\x80"),
            "?31m??");
  EXPECT_EQ(printable("cut \xe2\x82"), "cut ??");
  EXPECT_EQ(printable("\xc0\x80 \xc1\x9b"), "?? ??");                 // overlong
  EXPECT_EQ(printable("\xe0\x82\x9b \xf0\x82\x82\x9b"), "??? ????");  // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "???");                        // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80 \xf5\x80\x80\x80"), "???? ????");
  EXPECT_EQ(printable("\xc2"
                      "A"),
            "?A");
}

// Whatever the bytes, nothing below is left of them.
TEST(Printable, LeavesNoneInAnyPairOfBytes) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string pair{static_cast<char>(first), static_cast<char>(second)};
      for (const char c : one_line(pair)) {
        ASSERT_FALSE(static_cast<unsigned char>(c) < 0x20 || c == 0x7f) << first << ' ' << second;
      }
    }
  }
}

TEST(Printable, MakesOneLine) { EXPECT_EQ(one_line("a\r\nb\tc\x1b"), "a  b c?"); }

}  // namespace
}  // namespace maide
