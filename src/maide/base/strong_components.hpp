// Strongly connected components of a graph that is small enough to be numbered (Tarjan,
// "Depth-first search and linear graph algorithms", SIAM J. Comput. 1972). The recursion is a
// vector, since paths may be long. O(nodes + edges).
//
// An example: with edges 0 -> 1, 1 -> 2, 2 -> 1, from 0, the components are {1, 2} and {0}. A graph
// whose nodes are found while it is searched has searches of its own (fair_cycle.hpp,
// lone_time_outs.cpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"

namespace maide {

// The components of what can be reached from `starts`, each sorted, none before one that it leads
// to. `successors(node)` gives a vector of nodes, below `size`; it is called once for each node.
template <typename Successors>
std::vector<std::vector<std::size_t>> strong_components(std::size_t size,
                                                        const std::vector<std::size_t>& starts,
                                                        Successors&& successors) {
  struct Call {
    std::size_t node, low;
    std::vector<std::size_t> targets;  // not yet looked at
  };
  std::vector<std::vector<std::size_t>> components;
  std::vector<std::size_t> order(size, 0);  // from 1; 0: not yet visited
  std::vector<bool> is_active(size);        // in no component yet
  std::vector<std::size_t> active;
  std::vector<Call> calls;
  std::size_t visited = 0;
  const auto enter = [&](std::size_t node) {
    order[node] = ++visited;
    is_active[node] = true;
    active.push_back(node);
    calls.push_back({node, visited, successors(node)});
  };
  const auto leave = [&] {
    const Call call = std::move(calls.back());
    calls.pop_back();
    if (!calls.empty()) calls.back().low = std::min(calls.back().low, call.low);
    if (call.low != order[call.node]) return;
    const auto first = std::find(active.rbegin(), active.rend(), call.node).base() - 1;
    auto& component = components.emplace_back(first, active.end());
    active.erase(first, active.end());
    for (const std::size_t member : component) is_active[member] = false;
    std::ranges::sort(component);
  };
  for (const std::size_t start : starts) {
    if (order[start] == 0) enter(start);
    while (!calls.empty()) {
      Call& call = calls.back();
      if (call.targets.empty()) {
        leave();
        continue;
      }
      const std::size_t target = call.targets.back();
      call.targets.pop_back();
      if (order[target] == 0) {
        enter(target);
      } else if (is_active[target]) {
        call.low = std::min(call.low, order[target]);
      }
    }
  }
  MAIDE_CHECK(active.empty());  // every component that was entered is closed
  return components;
}

}  // namespace maide
