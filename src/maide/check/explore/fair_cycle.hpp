// On-the-fly search for a run that a monitor watches and accepts: a cycle in the product of system
// and monitor (product_graph.hpp) that has every mark. The algorithm is Couvreur's ("On-the-fly
// verification of linear temporal logic", FM 1999): Tarjan's components are merged with their marks
// as they are found. A generalised Buchi automaton is such a monitor, and so is "this program never
// steps again". Fairness is more marks.
//
// With stubborn sets only their steps are taken. A node from which one of them leads back to the
// search's path is expanded whole, so no step is left out all the way round a cycle (Peled,
// "Combining partial order reductions with on-the-fly model-checking", FMSD 1996). Marks always
// count every program that can step, left out or not.
//
// Without stubborn sets all nodes are visited. Among nodes in which the monitor still waits there
// is no cycle to be found, so not every transition between them is taken (step_order.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/check/explore/fair_lasso.hpp"
#include "maide/check/explore/product_graph.hpp"
#include "maide/check/explore/search.hpp"
#include "maide/check/explore/step_order.hpp"
#include "maide/check/explore/stubborn_sets.hpp"

namespace maide {

// A stack that may become very large: its items lie in pieces of one size, so that growing moves
// nothing and holds nothing twice, and what is popped is given back.
template <typename Item>
class ChunkedStack {
 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }

  // Throws std::bad_alloc, and then nothing was pushed.
  void push(const Item& item) {
    if (size_ == chunks_.size() * chunk_items) {
      chunks_.push_back(std::make_unique_for_overwrite<Item[]>(chunk_items));
    }
    (*this)[size_] = item;
    ++size_;
  }
  Item& top() {
    MAIDE_CHECK(size_ > 0);
    return (*this)[size_ - 1];
  }
  void pop() { shrink_to(size_ - 1); }
  // Pops the items from number `size` on.
  void shrink_to(std::size_t size) {
    MAIDE_CHECK(size <= size_);
    size_ = size;
    // One empty piece is kept: the top may go up and down at its edge.
    while (chunks_.size() > size / chunk_items + 2) chunks_.pop_back();
  }
  Item& operator[](std::size_t index) { return chunks_[index / chunk_items][index % chunk_items]; }
  const Item& operator[](std::size_t index) const {
    return chunks_[index / chunk_items][index % chunk_items];
  }

  // What it holds, in bytes; `chunk_bytes`: what it grows by.
  std::uint64_t bytes() const { return chunks_.size() * chunk_bytes; }
  static constexpr std::size_t chunk_items = std::size_t{1} << 14;
  static constexpr std::uint64_t chunk_bytes = chunk_items * sizeof(Item);

 private:
  std::vector<std::unique_ptr<Item[]>> chunks_;
  std::size_t size_ = 0;
};

template <std::size_t words, typename Monitor>
class FairCycleSearch {
 public:
  // `system` was made with node_number_bits of payload and the monitor's states. `sets`: null takes
  // every step; of at most 64 programs.
  FairCycleSearch(const PackedSystem& system, const Monitor& monitor, const SearchLimits& limits,
                  StubbornSets* sets = nullptr)
      : graph_(system, monitor), limits_(limits), sets_(sets) {
    if (sets_ == nullptr && monitor.may_wait()) order_.emplace(system);
  }

  SearchResult run() {
    try {
      search();
    } catch (const std::bad_alloc&) {
      result_.end = SearchResult::End::out_of_memory;
    } catch (const Interrupted&) {
      result_.end = SearchResult::End::stopped;
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
  using Bits = typename Graph::Bits;

  using Address = typename Graph::Address;
  using Step = typename Graph::Steps::One;

  // A node on the path.
  struct Frame {
    Number node = 0;
    std::uint32_t open = 0;  // of its edges, the last ones of open_
  };
  // An edge whose target was not known when its source was expanded.
  struct Open {
    State target;
    // To a node in which the monitor waits: what the step leaves out. Else its marks, but none from
    // where the monitor waits: no cycle passes there.
    Bits marks_or_last{};
  };
  struct Root {
    Bits marks{};     // inside the component
    Bits incoming{};  // of the edge by which it was entered
    Number node = 0;
    Number first_active = 0;  // of the component's nodes, in active_, which has no more than these
    bool has_edge = false;    // inside the component
    bool may_accept = true;   // the monitor does not wait
  };
  static_assert(sizeof(Root) <= 2 * sizeof(Bits) + 2 * sizeof(std::uint64_t));
  // An edge of the node that is expanded.
  struct Successor {
    Edge edge;
    Address address;
    Number number = Graph::no_node;  // if it was known
  };

  std::uint64_t bytes() const {
    return graph_.bytes() + (is_dead_.capacity() + is_on_path_.capacity()) / 8 + frames_.bytes() +
           open_.bytes() + active_.bytes() + roots_.bytes();
  }
  std::uint64_t growth_bytes() const {
    const std::uint64_t chunks =
        frames_.chunk_bytes + 8 * open_.chunk_bytes + active_.chunk_bytes + roots_.chunk_bytes;
    return graph_.growth_bytes(limit_interval) + FairLasso<Graph>::bytes(graph_) + chunks;
  }

  void search() {
    for (const State& node : graph_.first_nodes()) {
      if (!enter({node, StepOrder::first_state})) continue;
      if (is_over_ || search_from_top()) return;
    }
  }

  // True if the search is over.
  bool search_from_top() {
    while (!frames_.empty()) {
      if (frames_.top().open == 0) {
        leave();
        if (is_over_) return true;
        continue;
      }
      const Open edge = open_.top();
      open_.pop();
      --frames_.top().open;
      if (!open_.empty()) graph_.prefetch(graph_.address_of(open_.top().target));
      if (!enter(edge)) merge(known_, is_waiting(edge.target) ? Bits{} : edge.marks_or_last);
      if (is_over_) return true;
    }
    // The whole of what was found is in components that are complete.
    MAIDE_CHECK(open_.empty() && roots_.empty() && active_.empty());
    return false;
  }

  // True if the node is new; it is then the top of the path.
  bool enter(const Open& edge) {
    const State& node = edge.target;
    const auto [number, is_new] = graph_.insert(node);
    known_ = number;
    if (!is_new) return false;
    MAIDE_CHECK(number == is_dead_.size() && number == is_on_path_.size());
    is_dead_.push_back(false);
    is_on_path_.push_back(true);
    const bool may_accept = !graph_.monitor().is_waiting(graph_.monitor_state(node));
    const bool has_last = order_ && !may_accept;
    const auto first_active = static_cast<Number>(active_.size());
    roots_.push(
        {{}, has_last ? Bits{} : edge.marks_or_last, number, first_active, false, may_accept});
    active_.push(number);
    frames_.push({number, 0});
    result_.depth = std::max<std::uint64_t>(result_.depth, frames_.size());
    if (graph_.monitor_state(node) == graph_.monitor().universal()) {
      found([at = number](FairLasso<Graph>& lasso) { return lasso.prefix_to({at}); });
      return true;
    }
    expand(edge);
    if (!is_over_ && graph_.size() % limit_interval == 0 &&
        !may_go_on(limits_, graph_.size(), bytes(), growth_bytes(), result_)) {
      is_over_ = true;
    }
    return true;
  }

  // Edges to known nodes are looked at now, the others are put aside.
  void expand(const Open& incoming) {
    const State& node = incoming.target;
    graph_.find_steps(node, steps_);
    successors_.clear();
    if (is_waiting(node)) {
      find_successors_in_order(
          node, (*order_)[static_cast<std::uint32_t>(lowest_word(incoming.marks_or_last))]);
    } else {
      find_reduced_successors(node);
    }
    for (const Successor& successor : successors_) {
      ++result_.transitions;
      const Edge& edge = successor.edge;
      if (successor.number == Graph::no_node) {
        open_.push({edge.target, marks_or_last(node, edge)});
        ++frames_.top().open;
      } else {
        merge(successor.number, is_waiting(node) ? Bits{} : edge.marks);
        if (is_over_) return;
      }
    }
  }

  bool is_waiting(const State& node) const {
    return order_ && graph_.monitor().is_waiting(graph_.monitor_state(node));
  }
  Bits marks_or_last(const State& node, const Edge& edge) const {
    if (!is_waiting(edge.target)) return is_waiting(node) ? Bits{} : edge.marks;
    if (!edge.is_step || graph_.monitor_state(edge.target) != graph_.monitor_state(node)) {
      return StepOrder::first_state;
    }
    return order_->behind(graph_.system(), graph_.plain(node), edge.program, edge.edge);
  }

  void find_reduced_successors(const State& node) {
    if (sets_ == nullptr) return find_successors(node, [](const Step&) { return true; });
    const std::uint64_t programs = sets_->select(graph_.plain(node));
    if (!sets_->is_reduced()) return find_successors(node, [](const Step&) { return true; });
    find_successors(node, [&](const Step& step) { return (programs >> step.program & 1) != 0; });
    if (std::any_of(successors_.begin(), successors_.end(), [&](const Successor& successor) {
          return successor.number != Graph::no_node && is_on_path_[successor.number];
        })) {
      find_successors(node, [&](const Step& step) { return (programs >> step.program & 1) == 0; });
    }
  }

  void find_successors_in_order(const State& node, const StepOrder::Last& last) {
    find_successors(node, [&](const Step& step) {
      return step.program >= last.program || !order_->leaves_out(last, step.program, step.edge);
    });
  }

  // Appends the edges by the steps that are wanted.
  template <typename IsWanted>
  void find_successors(const State& node, IsWanted&& is_wanted) {
    const std::size_t first = successors_.size();
    graph_.for_each_wanted_edge(node, steps_, is_wanted, [&](const Edge& edge) {
      const Address address = graph_.address_of(edge.target);
      graph_.prefetch(address);
      successors_.push_back({edge, address});
    });
    for (std::size_t i = first; i < successors_.size(); ++i) {
      Successor& successor = successors_[i];
      successor.number = graph_.find(successor.edge.target, successor.address);
    }
  }

  // An edge from the top to a node that is known.
  void merge(Number known, Bits marks) {
    if (is_dead_[known]) return;
    while (roots_.top().node > known) {
      marks |= roots_.top().marks | roots_.top().incoming;
      roots_.pop();
    }
    MAIDE_CHECK(active_[roots_.top().first_active] == roots_.top().node);
    roots_.top().marks |= marks;
    roots_.top().has_edge = true;
    if (roots_.top().marks != graph_.all_marks() || graph_.wants_more()) return;
    found_round(members_from(roots_.top().first_active));
  }

  // The active nodes from that one on.
  std::vector<Number> members_from(std::size_t first) const {
    std::vector<Number> members;
    for (std::size_t i = first; i < active_.size(); ++i) members.push_back(active_[i]);
    return members;
  }

  // The top has no more edges.
  void leave() {
    const Number node = frames_.top().node;
    MAIDE_CHECK(is_on_path_[node] && !is_dead_[node]);
    frames_.pop();
    is_on_path_[node] = false;
    const Root root = roots_.top();
    MAIDE_CHECK(root.node <= node && root.first_active < active_.size());
    if (root.node != node) return;
    roots_.pop();
    if (graph_.wants_more() && root.has_edge && root.may_accept &&
        root.marks == graph_.all_marks()) {
      graph_.list_nodes();
      check_whole(members_from(root.first_active));
    }
    for (std::size_t i = root.first_active; i < active_.size(); ++i) is_dead_[active_[i]] = true;
    active_.shrink_to(root.first_active);
  }

  // Under strong fairness a component is looked at once it is complete.
  void check_whole(std::vector<Number> members) {
    FairParts<Graph> parts(graph_, limits_.control);
    if (const auto part = parts.find(std::move(members))) found_round(*part);
  }

  void found_round(const std::vector<Number>& members) {
    found([&](FairLasso<Graph>& lasso) { return lasso.run_round(members); });
  }

  // There is a violation; `run(lasso)` makes the run that is shown.
  template <typename Run>
  void found(Run&& run) {
    is_over_ = true;
    result_.has_violation = true;
    graph_.list_nodes();
    FairLasso<Graph> lasso(graph_, limits_.control);
    result_.bytes = std::max(result_.bytes, bytes() + lasso.bytes(graph_));
    result_.trace = run(lasso);
    result_.end = SearchResult::End::found;
  }

  Graph graph_;
  const SearchLimits& limits_;
  StubbornSets* sets_;
  std::optional<StepOrder> order_;
  std::vector<bool> is_dead_, is_on_path_;  // by node
  ChunkedStack<Frame> frames_;
  ChunkedStack<Open> open_;
  ChunkedStack<Number> active_;  // nodes of components that are not complete, ascending
  ChunkedStack<Root> roots_;
  Number known_ = 0;  // the node that enter() found
  bool is_over_ = false;
  typename Graph::Steps steps_;
  std::vector<Successor> successors_;
  SearchResult result_;
};

}  // namespace maide
