// Makes the run that is shown for an accepted strongly connected set of a product's nodes. The run
// takes a shortest way into the set. In it, it goes past every mark, past the answer of every pair
// that it comes to ask and, with strong fairness, past a step of every program, and of every fair
// group, that can step there. It always goes to the nearest of what is still missing. Eight bytes a
// node of the product. Throws Interrupted when the control says to stop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/strong_components.hpp"
#include "maide/check/search/product_graph.hpp"
#include "maide/check/search/search.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

// A strongly connected set of a product's nodes, with the edges between them.
template <typename Graph>
struct FairPart {
  std::vector<typename Graph::Number> members;  // sorted
  typename Graph::Bits barred{};                // edges with one of these marks are not in it
};

// Finds, for strong fairness and for pairs, a part of a strongly connected set that is accepted. A
// program, or a fair group, that can step in a set and never does is not treated fairly. So the
// nodes where it can step are left out, and the rest is taken apart again. So are the edges that
// ask a pair which no edge of the set answers (Emerson & Lei, "Modalities for model checking", Sci.
// Comput. Program. 1987).
template <typename Graph>
class FairParts {
 public:
  using Number = typename Graph::Number;
  using Share = typename Graph::Share;
  using Part = FairPart<Graph>;

  FairParts(const Graph& graph, const RunControl& control) : graph_(graph), control_(control) {}

  // A part with every mark in which each program and group that can step does, and each pair that
  // is asked is answered, if there is one. At most as many rounds as there are of these. Throws
  // Interrupted when the control says to stop.
  std::optional<Part> find(Part whole) {
    std::vector<Part> open;
    open.push_back(std::move(whole));
    while (!open.empty()) {
      Part part = std::move(open.back());
      open.pop_back();
      typename Graph::Bits marks{};
      Share able, stepped;
      bool has_edge = false;
      for (const Number member : part.members) {
        look();
        if (graph_.wants_more()) able = able | graph_.able(member);
        for_each_edge_within(graph_, part, member, [&](const auto& edge, Number) {
          has_edge = true;
          marks |= edge.marks;
          stepped = stepped | graph_.share_of(edge);
        });
      }
      if (!has_edge || !graph_.has_all(marks)) continue;
      const Share starved = able.without(stepped);
      const auto unanswered = graph_.unanswered(marks);
      if (starved.is_empty() && is_none(unanswered)) return part;
      Part rest;
      rest.barred = part.barred | unanswered;
      for (const Number member : part.members) {
        const bool is_left = starved.is_empty() || (graph_.able(member) & starved).is_empty();
        if (is_left) rest.members.push_back(member);
      }
      for (Part& component : components_of(rest)) open.push_back(std::move(component));
    }
    return std::nullopt;
  }

  // The strongly connected components of nodes and edges, which need not be connected.
  std::vector<Part> components_of(const Part& part) {
    const auto& nodes = part.members;
    std::vector<std::size_t> places(nodes.size());
    std::iota(places.begin(), places.end(), 0);
    const auto successors = [&](std::size_t place) {
      std::vector<std::size_t> targets;
      for_each_edge_within(graph_, part, nodes[place], [&](const auto&, Number target) {
        look();
        targets.push_back(
            static_cast<std::size_t>(std::ranges::lower_bound(nodes, target) - nodes.begin()));
      });
      return targets;
    };
    std::vector<Part> result;
    for (const auto& component : strong_components(nodes.size(), places, successors)) {
      Part& found = result.emplace_back();
      found.barred = part.barred;
      for (const std::size_t place : component) found.members.push_back(nodes[place]);
    }
    return result;
  }

 private:
  void look() {
    if (++looked_at_ % limit_interval == 0) control_.check("the search for a fair cycle");
  }

  const Graph& graph_;
  const RunControl& control_;
  std::uint64_t looked_at_ = 0;
};

// Visits the part's edges from `member`, and where they lead.
template <typename Graph, typename Visit>
void for_each_edge_within(const Graph& graph, const FairPart<Graph>& part,
                          typename Graph::Number member, Visit&& visit) {
  graph.for_each_edge(member, [&](const auto& edge) {
    if (!is_none(edge.marks & part.barred)) return;
    const auto number = graph.find(edge.target);
    if (number == Graph::no_node) return;
    if (std::ranges::binary_search(part.members, number)) visit(edge, number);
  });
}

template <typename Graph>
class FairLasso {
 public:
  using Number = typename Graph::Number;
  using Edge = typename Graph::Edge;
  using Share = typename Graph::Share;
  using Part = FairPart<Graph>;
  using Set = std::vector<Number>;  // sorted

  // For the nodes that the graph has when this is made. Keeps references. Throws std::bad_alloc.
  // `first`: where runs begin; none: at the graph's first nodes.
  FairLasso(const Graph& graph, const RunControl& control, Set first = {})
      : graph_(graph), control_(control), first_(std::move(first)), parents_(graph.size(), unseen) {
    queue_.reserve(graph.size());
    if (!first_.empty()) return;
    for (const auto& node : graph_.first_nodes()) {
      const Number number = graph_.find(node);
      if (number != Graph::no_node) first_.push_back(number);
    }
  }

  static std::uint64_t bytes(const Graph& graph) { return 2 * sizeof(Number) * graph.size(); }

  // A shortest run, in nodes that the graph knows, to one of `goals`.
  Trace prefix_to(const Set& goals, Number* reached = nullptr) {
    std::vector<Edge> path;
    const Number end = shortest_path(
        first_, nullptr, [&](Number node) { return std::ranges::binary_search(goals, node); },
        path);
    if (reached != nullptr) *reached = end;
    Trace trace;
    append(path, trace);
    return trace;
  }

  Trace run_round(const Part& part) {
    Number start = 0;
    Trace trace = prefix_to(part.members, &start);
    const Share wanted = wanted_steps(part.members);
    std::vector<Edge> loop;
    typename Graph::Bits marks{};
    Share stepped;
    Number at = start;
    const auto take = [&](const Edge& edge) {
      loop.push_back(edge);
      marks |= edge.marks;
      stepped = stepped | graph_.share_of(edge);
    };
    const auto is_done = [&] {
      return graph_.is_accepted(marks) && wanted.without(stepped).is_empty();
    };
    const auto is_useful = [&](const Edge& edge) {
      return is_done() || !is_none(edge.marks & graph_.all_marks() & ~marks) ||
             !is_none(graph_.answered(edge.marks) & graph_.unanswered(marks)) ||
             !(graph_.share_of(edge) & wanted.without(stepped)).is_empty();
    };
    // At least one edge, and then whatever is missing; then home, and on if the way asked more.
    do {
      while (loop.empty() || !is_done()) {
        std::optional<Edge> next;
        Number target = 0;
        std::vector<Edge> path;
        shortest_path(
            {at}, &part,
            [&](Number node) {
              for_each_edge_within(graph_, part, node, [&](const Edge& edge, Number to) {
                if (next || !is_useful(edge)) return;
                next = edge;
                target = to;
              });
              return next.has_value();
            },
            path);
        MAIDE_CHECK(next && is_useful(*next));
        for (const Edge& edge : path) take(edge);
        take(*next);
        at = target;
      }
      std::vector<Edge> home;
      shortest_path(
          {at}, &part, [&](Number node) { return node == start; }, home);
      for (const Edge& edge : home) take(edge);
      at = start;
    } while (!is_done());
    MAIDE_CHECK(graph_.find(loop.back().target) == start);
    const std::size_t loop_start = trace.steps.size();
    append(loop, trace);
    if (trace.steps.size() > loop_start) trace.loop_start = loop_start;
    return trace;
  }

 private:
  Share wanted_steps(const Set& members) const {
    Share wanted;
    if (!graph_.wants_more()) return wanted;
    for (const Number member : members) wanted = wanted | graph_.able(member);
    return wanted;
  }

  // From one of `first` to a node that `is_goal`; of a path without edges the first one. Appends
  // the edges to `path`; keeps within `part` if there is one. O(what it comes by).
  template <typename IsGoal>
  Number shortest_path(const Set& first, const Part* part, IsGoal&& is_goal,
                       std::vector<Edge>& path) {
    for (const Number node : queue_) parents_[node] = unseen;
    queue_.clear();
    const auto see = [this](Number node, Number parent) {
      if (parents_[node] != unseen) return;
      parents_[node] = parent;
      queue_.push_back(node);
    };
    for (const Number node : first) see(node, Graph::no_node);
    for (std::size_t at = 0; at < queue_.size(); ++at) {
      if (++looked_at_ % limit_interval == 0) control_.check("the search for a run to show");
      const Number node = queue_[at];
      if (is_goal(node)) {
        append_path_to(node, part, path);
        return node;
      }
      if (part != nullptr) {
        for_each_edge_within(graph_, *part, node,
                             [&](const Edge&, Number number) { see(number, node); });
        continue;
      }
      graph_.for_each_edge(node, [&](const Edge& edge) {
        const Number number = graph_.find(edge.target);
        if (number != Graph::no_node) see(number, node);
      });
    }
    throw std::logic_error("the search lost a node");
  }

  void append_path_to(Number node, const Part* part, std::vector<Edge>& path) const {
    const std::size_t start = path.size();
    for (; parents_[node] != Graph::no_node; node = parents_[node]) {
      path.push_back(edge_between(parents_[node], node, part));
    }
    std::reverse(path.begin() + static_cast<std::ptrdiff_t>(start), path.end());
    MAIDE_CHECK(path.size() - start < queue_.size());
  }

  Edge edge_between(Number from, Number to, const Part* part) const {
    std::optional<Edge> found;
    graph_.for_each_edge(from, [&](const Edge& edge) {
      if (part != nullptr && !is_none(edge.marks & part->barred)) return;
      if (!found && edge.target == graph_.node(to)) found = edge;
    });
    return found.value();
  }

  void append(const std::vector<Edge>& path, Trace& trace) const {
    for (const Edge& edge : path) {
      if (edge.is_step) trace.steps.push_back(graph_.steps().undo(edge.target, edge.code).step);
    }
  }

  static constexpr Number unseen = Graph::no_node - 1;

  const Graph& graph_;
  const RunControl& control_;
  Set first_;                    // in any order
  std::vector<Number> parents_;  // by node: on the way from the first ones, whose is no_node
  Set queue_;                    // nodes that were seen
  std::uint64_t looked_at_ = 0;
};

}  // namespace maide
