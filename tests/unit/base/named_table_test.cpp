// Rows are found by name; an unknown name is answered with the one that is near, or with all.
#include <gtest/gtest.h>

#include <array>

#include "maide/base/text.hpp"

namespace maide {
namespace {

struct Row {
  std::string_view name;
  int value;
};

TEST(NamedTable, FindsItsRows) {
  constexpr std::array<Row, 2> table{{{"one", 1}, {"two", 2}}};
  EXPECT_EQ(find_row(std::span<const Row>(table), "number", "two").value, 2);
  try {
    find_row(std::span<const Row>(table), "number", "three");
    FAIL() << "it was found";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown number 'three'; known are: one, two");
  }
  try {
    find_row(std::span<const Row>(table), "number", "tow");
    FAIL() << "it was found";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown number 'tow'; did you mean 'two'?");
  }
  EXPECT_STREQ(unknown_name("symbol", "x", {}).what(), "unknown symbol 'x'; known are: none");
}

TEST(Join, PutsTheSeparatorBetweenNames) {
  EXPECT_EQ(join({}), "");
  EXPECT_EQ(join(std::vector<std::string>{"", "b"}), ", b");
  EXPECT_EQ(join(std::vector<std::string>{"a", "b"}, " "), "a b");
}

}  // namespace
}  // namespace maide
