// The hash against the reference values of its authors' test suite: caches and file names keep it.
#include "maide/base/hash.hpp"

#include <gtest/gtest.h>

namespace maide {
namespace {

TEST(Hash, IsFnv1a) {
  EXPECT_EQ(hash_text(""), 0xcbf29ce484222325ULL);
  EXPECT_EQ(hash_text("a"), 0xaf63dc4c8601ec8cULL);
  EXPECT_EQ(hash_text("foobar"), 0x85944171f73967e8ULL);
  EXPECT_EQ(hash_step(hash_start, 'a'), hash_text("a"));
}

}  // namespace
}  // namespace maide
