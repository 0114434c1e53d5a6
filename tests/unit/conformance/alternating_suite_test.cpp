// Two suites in turn: the order, the limits, and what is counted.
#include <gtest/gtest.h>

#include <string>

#include "maide/conformance/suite/random_words.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {
namespace {

// `count` words of one input.
class Repeated : public TestSuite {
 public:
  Repeated(Symbol input, std::uint64_t count) : input_(input), left_(count), count_(count) {}
  bool next(Word& word) override {
    if (left_ == 0) return false;
    --left_;
    word = {input_};
    return true;
  }
  std::optional<std::uint64_t> size() const override { return count_; }

 private:
  Symbol input_;
  std::uint64_t left_, count_;
};

std::string order(std::uint64_t first, std::uint64_t second, std::uint64_t head_start) {
  Repeated left(0, 5), right(1, 5);
  AlternatingSuite suite({left, first}, {right, second}, head_start);
  std::string order;
  Word word;
  while (suite.next(word)) order += word == Word{0} ? 'a' : 'b';
  EXPECT_EQ(suite.size(), order.size());
  EXPECT_FALSE(suite.next(word));
  return order;
}

TEST(AlternatingSuite, TakesTurnsAfterTheHeadStart) {
  EXPECT_EQ(order(4, 3, 0), "abababa");
  EXPECT_EQ(order(5, 3, 2), "aaababab");
  EXPECT_EQ(order(2, 4, 1), "aabbbb");
  EXPECT_EQ(order(3, 0, 9), "aaa");
  EXPECT_EQ(order(0, 2, 9), "bb");
  EXPECT_EQ(order(0, 0, 0), "");
  EXPECT_EQ(order(9, 2, 9), "aaaaabb") << "a suite that ends before its limit";
}

TEST(AlternatingSuite, LimitsEndlessSuites) {
  Repeated few(0, 3);
  RandomWordSuite endless(2, 1, 4, Random(1));
  AlternatingSuite suite({endless, 10}, {few, 100}, 4);
  EXPECT_EQ(suite.size(), 13U);
  Word word;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(suite.next(word));
  EXPECT_EQ(suite.made_of_first(), 5U);
  EXPECT_EQ(suite.made_of_second(), 0U);
  ASSERT_TRUE(suite.next(word));
  EXPECT_EQ(suite.made_of_second(), 1U);
}

}  // namespace
}  // namespace maide
