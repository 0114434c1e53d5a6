// Strong fairness: a part of a strongly connected set of a product's nodes that is accepted. A
// program that can step there and never does is not treated fairly, so the nodes where it can are
// left out, and what remains is taken apart again (Emerson & Lei, "Modalities for model checking",
// Sci. Comput. Program. 1987).
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "maide/check/product_graph.hpp"
#include "maide/check/search.hpp"

namespace maide {

template <typename Graph>
class FairParts {
 public:
  using Number = typename Graph::Number;
  using Set = std::vector<Number>;  // sorted

  FairParts(const Graph& graph, const RunControl& control) : graph_(graph), control_(control) {}

  // A part with every mark in which each program that can step does, if there is one. At most as
  // many rounds as there are programs. Throws Interrupted when the control says to stop.
  std::optional<Set> find(Set members) {
    std::vector<Set> open{std::move(members)};
    while (!open.empty()) {
      const Set set = std::move(open.back());
      open.pop_back();
      std::uint64_t marks = 0, enabled = 0, stepped = 0;
      bool has_edge = false;
      for (const Number member : set) {
        look();
        enabled |= graph_.enabled_programs(member);
        for_each_edge_within(graph_, set, member, [&](const auto& edge, Number) {
          has_edge = true;
          marks |= edge.marks;
          if (edge.is_step) stepped |= std::uint64_t{1} << edge.program;
        });
      }
      if (!has_edge || marks != graph_.all_marks()) continue;
      const std::uint64_t starved = enabled & ~stepped;
      if (starved == 0) return set;
      Set rest;
      for (const Number member : set) {
        if ((graph_.enabled_programs(member) & starved) == 0) rest.push_back(member);
      }
      for (Set& component : components_of(rest)) open.push_back(std::move(component));
    }
    return std::nullopt;
  }

 private:
  void look() {
    if (++looked_at_ % limit_interval == 0) control_.check("the search for a fair cycle");
  }

  // Tarjan's components of a set of nodes (iterative; SIAM J. Comput. 1972).
  std::vector<Set> components_of(const Set& set) {
    struct Open {
      std::size_t place;
      std::vector<std::size_t> targets;  // not yet looked at
    };
    std::vector<Set> result;
    std::vector<std::uint32_t> low(set.size(), 0), order(set.size(), 0);
    std::vector<bool> is_active(set.size());
    std::vector<std::size_t> active;
    std::vector<Open> path;
    std::uint32_t count = 0;
    const auto enter = [&](std::size_t place) {
      order[place] = low[place] = ++count;
      is_active[place] = true;
      active.push_back(place);
      std::vector<std::size_t> targets;
      for_each_edge_within(graph_, set, set[place], [&](const auto&, Number target) {
        targets.push_back(static_cast<std::size_t>(
            std::lower_bound(set.begin(), set.end(), target) - set.begin()));
      });
      path.push_back({place, std::move(targets)});
    };
    const auto leave = [&](std::size_t place) {
      path.pop_back();
      if (!path.empty()) low[path.back().place] = std::min(low[path.back().place], low[place]);
      if (low[place] != order[place]) return;
      Set& component = result.emplace_back();
      std::size_t member = 0;
      do {
        member = active.back();
        active.pop_back();
        is_active[member] = false;
        component.push_back(set[member]);
      } while (member != place);
      std::sort(component.begin(), component.end());
    };
    for (std::size_t start = 0; start < set.size(); ++start) {
      if (order[start] == 0) enter(start);
      while (!path.empty()) {
        look();
        auto& targets = path.back().targets;
        const std::size_t place = path.back().place;
        if (targets.empty()) {
          leave(place);
          continue;
        }
        const std::size_t target = targets.back();
        targets.pop_back();
        if (order[target] == 0) {
          enter(target);
        } else if (is_active[target]) {
          low[place] = std::min(low[place], order[target]);
        }
      }
    }
    return result;
  }

  const Graph& graph_;
  const RunControl& control_;
  std::uint64_t looked_at_ = 0;
};

// `set` is sorted. Visits the edges from `member` that stay in it, and where they lead.
template <typename Graph, typename Visit>
void for_each_edge_within(const Graph& graph, const std::vector<typename Graph::Number>& set,
                          typename Graph::Number member, Visit&& visit) {
  graph.for_each_edge(member, [&](const auto& edge) {
    const auto number = graph.find(edge.target);
    if (number == Graph::no_node) return;
    if (std::binary_search(set.begin(), set.end(), number)) visit(edge, number);
  });
}

}  // namespace maide
