// The stack that lies in pieces.
#include <gtest/gtest.h>

#include "maide/base/random.hpp"
#include "maide/check/packed/chunks.hpp"

namespace maide {
namespace {

TEST(ChunkedStack, IsAStack) {
  Random random(1);
  ChunkedStack<std::uint32_t> stack;
  std::vector<std::uint32_t> expected;
  std::size_t most = 0;
  for (int round = 0; round < 400; ++round) {
    // Up by more than a chunk at times, down by more than a chunk at times, and at its edges.
    const std::size_t count = random.below(2 * stack.chunk_items);
    if (random.chance(0.55)) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto item = static_cast<std::uint32_t>(random());
        stack.push(item);
        expected.push_back(item);
      }
    } else if (random.chance(0.5)) {
      const std::size_t size = expected.size() - std::min(expected.size(), count);
      stack.shrink_to(size);
      expected.resize(size);
    } else {
      for (std::size_t i = 0; i < count && !expected.empty(); ++i) {
        ASSERT_EQ(stack.top(), expected.back());
        stack.pop();
        expected.pop_back();
      }
    }
    ASSERT_EQ(stack.size(), expected.size());
    ASSERT_EQ(stack.empty(), expected.empty());
    for (int look = 0; look < 100 && !expected.empty(); ++look) {
      const std::size_t index = random.below(expected.size());
      ASSERT_EQ(stack[index], expected[index]);
    }
    // What was popped is given back, but for a chunk or two.
    ASSERT_LE(stack.bytes(), expected.size() * sizeof(std::uint32_t) + 2 * stack.chunk_bytes);
    most = std::max(most, expected.size());
  }
  EXPECT_GT(most, 3 * stack.chunk_items);
}

}  // namespace
}  // namespace maide
