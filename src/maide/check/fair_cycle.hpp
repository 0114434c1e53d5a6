// On-the-fly search for a run that something watches and accepts: a cycle in the product of a
// system and a monitor (product_graph.hpp) that has every mark, after Couvreur, "On-the-fly
// verification of linear temporal logic", FM 1999 (Tarjan's components, merged with their marks as
// they are found). A generalised Buchi automaton is such a monitor, and so is "this program never
// steps again"; fairness is more marks.
//
// With stubborn sets only their steps are taken, but a node from which one of them leads back to
// the search's path is expanded whole, so that no step is left out all the way round a cycle
// (Peled, "Combining partial order reductions with on-the-fly model-checking", FMSD 1996). Marks
// always count every program that can step, left out or not.
#pragma once

#include <algorithm>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include "maide/check/fair_lasso.hpp"
#include "maide/check/fair_parts.hpp"
#include "maide/check/product_graph.hpp"
#include "maide/check/search.hpp"
#include "maide/check/stubborn_sets.hpp"

namespace maide {

template <std::size_t words, typename Monitor>
class FairCycleSearch {
 public:
  // `system` was made with node_number_bits of payload and the monitor's states. `sets`: null takes
  // every step.
  FairCycleSearch(const PackedSystem& system, const Monitor& monitor, const SearchLimits& limits,
                  StubbornSets* sets = nullptr)
      : graph_(system, monitor), limits_(limits), sets_(sets) {}

  SearchResult run() {
    try {
      search();
    } catch (const std::bad_alloc&) {
      result_.end = SearchResult::End::out_of_memory;
    }
    result_.states = graph_.size();
    result_.bytes = std::max(result_.bytes, bytes());
    return std::move(result_);
  }

 private:
  using Graph = ProductGraph<words, Monitor>;
  using State = typename Graph::State;
  using Edge = typename Graph::Edge;
  using Number = typename Graph::Number;

  struct Frame {
    Number node = 0;
    std::size_t first_edge = 0;  // in edges_; the next to be taken is the last
  };
  struct Root {
    Number node = 0;
    std::uint64_t marks = 0;     // inside the component
    std::uint64_t incoming = 0;  // of the edge by which it was entered
  };

  std::uint64_t bytes() const {
    return graph_.bytes() + (is_dead_.capacity() + is_on_path_.capacity()) / 8 + held(frames_) +
           held(edges_) + held(active_) + held(roots_);
  }
  template <typename Item>
  static std::uint64_t held(const std::vector<Item>& items) {
    return items.capacity() * sizeof(Item);
  }
  // A vector that is nearly full moves to a place of twice the size.
  template <typename Item>
  static std::uint64_t growth(const std::vector<Item>& items) {
    return items.size() + 8 * limit_interval > items.capacity() ? 2 * held(items) : 0;
  }
  std::uint64_t growth_bytes() const {
    return graph_.growth_bytes(limit_interval) + growth(frames_) + growth(edges_) +
           growth(active_) + growth(roots_);
  }

  void search() {
    for (const State& node : graph_.first_nodes()) {
      if (!enter(node, 0)) continue;
      if (is_over_ || search_from_top()) return;
    }
  }

  // True if the search is over.
  bool search_from_top() {
    while (!frames_.empty()) {
      const Frame& frame = frames_.back();
      if (edges_.size() == frame.first_edge) {
        leave();
        if (is_over_) return true;
        continue;
      }
      const Edge edge = edges_.back();
      edges_.pop_back();
      ++result_.transitions;
      if (!enter(edge.target, edge.marks)) merge(edge);
      if (is_over_) return true;
    }
    return false;
  }

  // True if the node is new; it is then the top of the path.
  bool enter(const State& node, std::uint64_t incoming) {
    const auto [number, is_new] = graph_.insert(node);
    known_ = number;
    if (!is_new) return false;
    is_dead_.push_back(false);
    is_on_path_.push_back(true);
    active_.push_back(number);
    roots_.push_back({number, 0, incoming});
    frames_.push_back({number, edges_.size()});
    expand(node);
    result_.depth = std::max<std::uint64_t>(result_.depth, frames_.size());
    if (graph_.size() % limit_interval == 0 &&
        !may_go_on(limits_, graph_.size(), bytes(), growth_bytes(), result_)) {
      is_over_ = true;
    }
    if (graph_.monitor_state(number) == graph_.monitor().universal()) {
      is_over_ = true;
      result_.end = SearchResult::End::found;
      result_.trace = FairLasso(graph_).prefix_to({number});
    }
    return true;
  }

  void expand(const State& node) {
    graph_.find_steps(node, steps_);
    std::uint64_t programs = ~std::uint64_t{0};
    if (sets_ != nullptr) {
      const std::uint64_t selected = sets_->select(graph_.plain(node));
      if (sets_->is_reduced()) programs = selected;
    }
    const std::size_t first = edges_.size();
    const auto add = [&](const Edge& edge) { edges_.push_back(edge); };
    graph_.for_each_edge(node, steps_, programs, add);
    if (programs == ~std::uint64_t{0}) return;
    const bool leads_back = std::any_of(edges_.begin() + static_cast<std::ptrdiff_t>(first),
                                        edges_.end(), [&](const Edge& edge) {
                                          const Number target = graph_.find(edge.target);
                                          return target != Graph::no_node && is_on_path_[target];
                                        });
    if (leads_back) graph_.for_each_edge(node, steps_, ~programs, add);
  }

  // An edge from the top to a node that is known.
  void merge(const Edge& edge) {
    if (is_dead_[known_]) return;
    std::uint64_t marks = edge.marks;
    while (roots_.back().node > known_) {
      marks |= roots_.back().marks | roots_.back().incoming;
      roots_.pop_back();
    }
    roots_.back().marks |= marks;
    if (roots_.back().marks != graph_.all_marks() || graph_.monitor().is_strong()) return;
    const auto first = std::lower_bound(active_.begin(), active_.end(), roots_.back().node);
    found({first, active_.end()});
  }

  // The top has no more edges.
  void leave() {
    const Number node = frames_.back().node;
    frames_.pop_back();
    is_on_path_[node] = false;
    if (roots_.back().node != node) return;
    const bool has_all = roots_.back().marks == graph_.all_marks();
    roots_.pop_back();
    const auto first = std::lower_bound(active_.begin(), active_.end(), node);
    if (graph_.monitor().is_strong() && has_all) check_whole({first, active_.end()});
    for (auto member = first; member != active_.end(); ++member) is_dead_[*member] = true;
    active_.erase(first, active_.end());
  }

  // Under strong fairness a component is looked at once it is complete.
  void check_whole(std::vector<Number> members) {
    FairParts<Graph> parts(graph_, limits_.control);
    if (const auto part = parts.find(std::move(members))) {
      found(*part);
    } else if (parts.is_stopped()) {
      is_over_ = true;
      result_.end = SearchResult::End::stopped;
    }
  }

  void found(const std::vector<Number>& members) {
    is_over_ = true;
    result_.end = SearchResult::End::found;
    result_.trace = FairLasso(graph_).run_round(members);
  }

  Graph graph_;
  const SearchLimits& limits_;
  StubbornSets* sets_;
  std::vector<bool> is_dead_, is_on_path_;  // by node
  std::vector<Frame> frames_;
  std::vector<Edge> edges_;
  std::vector<Number> active_;  // nodes of components that are not complete, ascending
  std::vector<Root> roots_;
  Number known_ = 0;  // the node that enter() found
  bool is_over_ = false;
  typename Graph::Steps steps_;
  SearchResult result_;
};

}  // namespace maide
