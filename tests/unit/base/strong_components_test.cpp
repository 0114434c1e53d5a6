// Components of random graphs against their meaning: each of two nodes can be reached from the
// other.
#include "maide/base/strong_components.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "maide/base/random.hpp"

namespace maide {
namespace {

using Graph = std::vector<std::vector<std::size_t>>;

std::vector<bool> reached_from(const Graph& graph, std::size_t start) {
  std::vector<bool> reached(graph.size());
  std::vector<std::size_t> open{start};
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    if (reached[node]) continue;
    reached[node] = true;
    for (const std::size_t target : graph[node]) open.push_back(target);
  }
  return reached;
}

TEST(StrongComponents, OfRandomGraphs) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    Graph graph(1 + random.below(9));
    for (std::size_t edges = random.below(2 * graph.size() + 1); edges > 0; --edges) {
      graph[random.below(graph.size())].push_back(random.below(graph.size()));
    }
    std::vector<std::vector<bool>> reached;
    for (std::size_t node = 0; node < graph.size(); ++node) {
      reached.push_back(reached_from(graph, node));
    }
    const std::size_t none = graph.size(), start = random.below(graph.size());
    std::vector<std::size_t> component_of(graph.size(), none);
    const auto components = strong_components(graph.size(), {start, start},
                                              [&](std::size_t node) { return graph[node]; });
    for (std::size_t number = 0; number < components.size(); ++number) {
      EXPECT_TRUE(std::is_sorted(components[number].begin(), components[number].end()));
      for (const std::size_t node : components[number]) {
        EXPECT_EQ(component_of[node], none) << "twice, seed " << seed;
        component_of[node] = number;
      }
    }
    for (std::size_t one = 0; one < graph.size(); ++one) {
      EXPECT_EQ(component_of[one] != none, reached[start][one]) << "seed " << seed;
      for (std::size_t other = 0; other < graph.size(); ++other) {
        if (component_of[one] == none || component_of[other] == none) continue;
        EXPECT_EQ(component_of[one] == component_of[other],
                  reached[one][other] && reached[other][one])
            << "seed " << seed;
        if (reached[one][other]) {
          EXPECT_GE(component_of[one], component_of[other]);
        }
      }
    }
  }
}

// A recursion would need a stack as long as the path.
TEST(StrongComponents, OfALongCycle) {
  const std::size_t size = 1'000'000;
  const auto components = strong_components(
      size, {0}, [&](std::size_t node) { return std::vector<std::size_t>{(node + 1) % size}; });
  ASSERT_EQ(components.size(), 1U);
  EXPECT_EQ(components.front().size(), size);
}

}  // namespace
}  // namespace maide
