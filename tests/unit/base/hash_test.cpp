// FNV-1a against the reference values of its authors' test suite: caches and file names keep it.
#include "maide/base/hash.hpp"

#include <gtest/gtest.h>

#include <set>

namespace maide {
namespace {

TEST(Hash, IsFnv1a) {
  EXPECT_EQ(hash_text(""), 0xcbf29ce484222325ULL);
  EXPECT_EQ(hash_text("a"), 0xaf63dc4c8601ec8cULL);
  EXPECT_EQ(hash_text("foobar"), 0x85944171f73967e8ULL);
  EXPECT_EQ(hash_step(hash_start, 'a'), hash_text("a"));
}

// Places in a table of 2^16, of values that differ in one bit or in a few low ones.
TEST(Hash, MixesBitsIntoTheLowOnes) {
  std::set<std::uint64_t> places;
  for (unsigned bit = 0; bit < 48; ++bit) places.insert(hash_mix(0, 1ULL << bit) & 0xffff);
  EXPECT_EQ(places.size(), 48U);
  places.clear();
  for (std::uint64_t value = 0; value < 1000; ++value) places.insert(hash_mix(1, value) & 0xffff);
  EXPECT_GT(places.size(), 950U);
  EXPECT_NE(hash_mix(hash_mix(0, 1), 2), hash_mix(hash_mix(0, 2), 1));
}

}  // namespace
}  // namespace maide
