// Suggestions are near, and there are none where nothing is near.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/base/text.hpp"

namespace maide {
namespace {

const std::vector<std::string> words{"depth", "history", "reliability", "at-bound"};

TEST(Suggest, DistanceCountsEdits) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("abc", "acb"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(Suggest, FindsTheNearest) {
  EXPECT_EQ(find_nearest("detph", words), "depth");
  EXPECT_EQ(find_nearest("at_bound", words), "at-bound");
  EXPECT_EQ(find_nearest("relaibilty", words), "reliability");
}

TEST(Suggest, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(find_nearest("xyz", words), "");
  EXPECT_EQ(find_nearest("", words), "");
  EXPECT_EQ(find_nearest("x", std::vector<std::string>{"y"}), "");
  EXPECT_EQ(did_you_mean("xyz", words), "");
  EXPECT_EQ(did_you_mean("hstory", words), "; did you mean 'history'?");
  EXPECT_EQ(find_nearest("DEPTH", words), "depth");
}

}  // namespace
}  // namespace maide
