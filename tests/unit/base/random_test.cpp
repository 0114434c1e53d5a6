// The generator against published reference values, and its bounded draws.
#include "maide/base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace maide {
namespace {

// First outputs of xoshiro256** whose state are splitmix64's first four outputs for the seed.
// splitmix64(0) starts e220a8397b1dcdaf, 6e789e6aa1b965f4, 06c45d188009454f, f88bb8a8724c81ec, so
// the first output is rotl(6e789e6aa1b965f4 * 5, 7) * 9.
TEST(Random, StartsAsTheReferenceDoes) {
  Random random(0);
  const std::uint64_t product = 0x6e789e6aa1b965f4ULL * 5;
  EXPECT_EQ(random(), ((product << 7) | (product >> 57)) * 9);
  EXPECT_EQ(Random(0)(), 0x99ec5f36cb75f2b4ULL);
}

TEST(Random, SameSeedSameNumbers) {
  Random first(7), second(7), other(8);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t bits = first();
    EXPECT_EQ(bits, second());
    differs = differs || bits != other();
  }
  EXPECT_TRUE(differs);
}

TEST(Random, BelowCoversItsRangeEvenly) {
  Random random(1);
  std::array<int, 7> seen{};
  for (int i = 0; i < 70000; ++i) ++seen[random.below(seen.size())];
  for (const int count : seen) EXPECT_NEAR(count, 10000, 500);
}

TEST(Random, BetweenIncludesBothEnds) {
  Random random(2);
  bool low = false, high = false;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t value = random.between(3, 5);
    ASSERT_TRUE(value >= 3 && value <= 5);
    low = low || value == 3;
    high = high || value == 5;
  }
  EXPECT_TRUE(low && high);
}

TEST(Random, UnitStaysInRange) {
  Random random(3);
  double sum = 0;
  for (int i = 0; i < 10000; ++i) {
    const double value = random.unit();
    ASSERT_TRUE(value >= 0 && value < 1);
    sum += value;
  }
  EXPECT_NEAR(sum / 10000, 0.5, 0.02);
}

TEST(Random, ShuffleIsAPermutation) {
  Random random(4);
  std::vector<int> values(50);
  std::iota(values.begin(), values.end(), 0);
  std::vector<int> shuffled = values;
  random.shuffle(shuffled);
  EXPECT_NE(shuffled, values);
  std::sort(shuffled.begin(), shuffled.end());
  EXPECT_EQ(shuffled, values);
}

}  // namespace
}  // namespace maide
