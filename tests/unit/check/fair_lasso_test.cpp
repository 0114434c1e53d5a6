#include "maide/check/search/fair_lasso.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/check/search/monitors.hpp"
#include "systems.hpp"

namespace maide {
namespace {

// The product of two programs that count and "who never steps again", all of it.
struct Counters {
  System plain = test::system_of(
      "  a: repeat 200 { if * {} }\n"
      "  b: repeat 100 { if * {} }\n");
  PackedSystem system{plain, node_number_bits, 3};
  StuckMonitor<> monitor{system, StuckRuns::weakly_fair};
  ProductGraph<1, StuckMonitor<>> graph{system, monitor};

  Counters() {
    for (const auto& node : graph.first_nodes()) graph.insert(node);
    graph.list_nodes();
    for (std::uint32_t number = 0; number < graph.size(); ++number) {
      graph.for_each_edge(number, [this](const auto& edge) { targets.push_back(edge.target); });
      for (const auto& target : targets) graph.insert(target);
      targets.clear();
    }
  }
  std::uint32_t last() const { return static_cast<std::uint32_t>(graph.size() - 1); }

  std::vector<PackedState<1>> targets;
};

TEST(FairLasso, ItsPrefixIsAShortestRun) {
  const Counters counters;
  const RunControl control;
  FairLasso lasso(counters.graph, control);
  // Three nodes are first ones: nobody is stuck yet, or either is from the start.
  EXPECT_EQ(lasso.prefix_to({2}).steps.size(), 0u);
  // Breadth-first the last node is as far away as any: where both have counted to the end.
  EXPECT_GE(lasso.prefix_to({counters.last()}).steps.size(), 300u);
  EXPECT_EQ(lasso.prefix_to({3}).steps.size(), 1u);
}

TEST(FairLasso, StopsWhenTold) {
  const Counters counters;
  ASSERT_GT(counters.graph.size(), limit_interval);
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  FairLasso lasso(counters.graph, control);
  EXPECT_THROW(lasso.prefix_to({counters.last()}), Interrupted);
}

}  // namespace
}  // namespace maide
