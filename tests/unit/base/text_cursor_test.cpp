#include "maide/base/text_cursor.hpp"

#include <gtest/gtest.h>

#include <string>

namespace maide {
namespace {

TEST(TextCursor, CountsLinesAndColumnsOfCharactersOrBytes) {
  for (const auto columns : {TextCursor::Columns::characters, TextCursor::Columns::bytes}) {
    TextCursor cursor("\u00e4\u20acx\n y", "f", columns);
    EXPECT_EQ(cursor.take_while([](char c) { return c != 'x'; }), "\u00e4\u20ac");
    EXPECT_EQ(cursor.place().column, columns == TextCursor::Columns::bytes ? 6 : 3);
    EXPECT_EQ(cursor.take_line(), "x");
    cursor.skip_blanks();
    EXPECT_EQ(cursor.place().line, 2);
    EXPECT_EQ(cursor.place().column, 2);
    try {
      cursor.fail("no", cursor.place());
    } catch (const ParseError& error) {
      EXPECT_STREQ(error.what(), "no (f:2:2)");
    }
  }
}

TEST(TextCursor, TakesWhatIsThereAndNoMore) {
  const std::string text("a\0b", 3);
  TextCursor cursor(text, "f", TextCursor::Columns::bytes);
  EXPECT_FALSE(cursor.accept("ab"));
  EXPECT_TRUE(cursor.accept("a"));
  EXPECT_EQ(cursor.peek(), '\0');
  EXPECT_FALSE(cursor.at_end()) << "a zero byte is no end";
  EXPECT_EQ(cursor.take(9).size(), 2U);
  EXPECT_TRUE(cursor.at_end());
  EXPECT_EQ(cursor.peek(), '\0');
  EXPECT_EQ(cursor.offset(), 3U);
  EXPECT_TRUE(cursor.rest().empty());
  EXPECT_TRUE(cursor.take_while([](char) { return true; }).empty());
  EXPECT_FALSE(cursor.accept("b"));
}

TEST(SplitLines, ALineBreakAtTheEndBeginsNoLine) {
  using Lines = std::vector<std::string_view>;
  EXPECT_EQ(split_lines(""), Lines());
  EXPECT_EQ(split_lines("\n"), Lines{""});
  EXPECT_EQ(split_lines("a\n\nb"), (Lines{"a", "", "b"}));
  EXPECT_EQ(split_lines("a\nb\n"), (Lines{"a", "b"}));
}

}  // namespace
}  // namespace maide
