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
// Streett pairs are taken with the marks. A component, or the part of one that was merged so far,
// in which every pair that is asked is answered has a cycle. If a complete component has an
// unanswered pair, a part of it may do without (FairParts).
//
// Without stubborn sets all nodes are visited. Among nodes in which the monitor still waits there
// is no cycle to be found, so not every transition between them is taken (step_order.hpp).
//
// Several threads search parts of the product beside each other (PartsSearch). A monitor's root is
// a state in which it waits, and may begin, and to which nothing else leads. So the nodes with a
// root are the system's states, which are searched breadth-first by all threads
// (breadth_first_search.hpp). Where a root goes depends on the system's state alone: the nodes
// behind are found from the table of these states. They fall into parts between which nothing
// leads, one for each program that may be stuck. No cycle lies in two parts, so each is searched as
// above, with a table of its own that goes when it is done. Parts of an automaton as the unit of
// distribution: Barnat, Brim & Cerna, "Property driven distribution of nested DFS", VMCAI 2002.
//
// Invariant: states and transitions of a search that comes to its end are the same whole and in
// parts. Of several parts with a violation the first counts, whatever the number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/thread_team.hpp"
#include "maide/check/packed/chunks.hpp"
#include "maide/check/reduce/step_order.hpp"
#include "maide/check/reduce/stubborn_sets.hpp"
#include "maide/check/search/breadth_first_search.hpp"
#include "maide/check/search/fair_lasso.hpp"
#include "maide/check/search/product_graph.hpp"
#include "maide/check/search/search.hpp"

namespace maide {

// A part of the product that is searched beside others: nodes in whose monitor state the part is.
template <std::size_t words>
struct ProductPart {
  using Reached = BreadthFirstSearch<words>;
  // What the searches of all parts tell each other.
  struct Shared {
    explicit Shared(unsigned count) : threads(count) {}
    unsigned threads;
    std::atomic<std::uint64_t> states = 0, bytes = 0;  // of all, what was reached included
    std::atomic<std::uint32_t> least_found = no_part;  // where there is a violation
  };
  const Reached& reached;  // the system's states, in each of which a root goes on to the part
  std::uint32_t number = 0;
  Shared& shared;
};

template <std::size_t words, typename Monitor>
class FairCycleSearch {
 public:
  using Part = ProductPart<words>;
  using State = PackedState<words>;
  static constexpr std::uint64_t no_budget = ~std::uint64_t{0};

  // `system` was made with node_number_bits of payload and the monitor's states. `sets`: null takes
  // every step; of at most 64 programs. `budget`: of nodes. `part`: null searches all. Keeps
  // references.
  FairCycleSearch(const PackedSystem& system, const Monitor& monitor, const SearchLimits& limits,
                  StubbornSets* sets = nullptr, std::uint64_t budget = no_budget,
                  const Part* part = nullptr)
      : graph_(system, monitor), limits_(limits), sets_(sets), budget_(budget), part_(part) {
    if (sets_ == nullptr && may_wait()) order_.emplace(system);
  }

  // It ended for its budget, and would have gone on.
  bool is_over_budget() const { return is_over_budget_; }

  SearchResult run() {
    return run([this] { search(); });
  }
  // Searches from that node on, to which `way` leads.
  SearchResult run_from(const State& node, Trace way) {
    way_ = std::move(way);
    return run([&] { search_from(node); });
  }
  // Visits the nodes in which the monitor waits breadth-first, and whatever lies behind each before
  // the next. So a run that is found leaves them as early as any.
  SearchResult run_nearest() {
    way_.emplace();
    return run([this] { search_nearest(); });
  }
  // Of a run that was found from some node on: that node, and the way there.
  const State& entry() const { return graph_.node(entry_); }
  const Trace& way() const { return *way_; }

 private:
  template <typename Search>
  SearchResult run(Search&& search) {
    try {
      search();
    } catch (const std::bad_alloc&) {
      result_.end = SearchResult::End::out_of_memory;
    } catch (const Interrupted&) {
      result_.end = SearchResult::End::stopped;
    }
    result_.states = graph_.size();
    if (part_ != nullptr) tell(0);
    result_.bytes = std::max(result_.bytes, bytes());
    return std::move(result_);
  }

  using Graph = ProductGraph<words, Monitor>;
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
      if (is_mine(graph_.monitor_state(node)) && search_from(node)) return;
    }
    if (part_ != nullptr) search_from_roots();
  }
  // True if the search is over.
  bool search_from(const State& node) {
    if (!enter({node, StepOrder::first_state})) return false;
    return is_over_ || search_from_top();
  }

  // A node in which the monitor waits, and how it was reached.
  struct Reached {
    State node;
    std::size_t before = 0;
    std::uint32_t code = 0;  // of the step
    bool is_step = false;    // else it is a first node, or the monitor alone went on
  };

  void search_nearest() {
    std::vector<Reached> reached;
    const auto waits = [this](const State& node) {
      return graph_.monitor().is_waiting(graph_.monitor_state(node));
    };
    const auto see = [&](const State& node, std::size_t before, std::uint32_t code, bool is_step) {
      if (!graph_.insert(node).is_new) return;
      is_dead_.push_back(true);  // no cycle with every mark passes there
      is_on_path_.push_back(false);
      reached.push_back({node, before, code, is_step});
    };
    for (const State& node : graph_.first_nodes()) {
      if (waits(node)) {
        see(node, 0, 0, false);
      } else if (search_from(node)) {
        return;
      }
    }
    std::vector<Edge> edges;  // searches from nodes come by others' edges
    for (std::size_t at = 0; at < reached.size(); ++at) {
      edges = graph_.edges_of(reached[at].node);
      for (const Edge& edge : edges) {
        if (waits(edge.target)) {
          see(edge.target, at, edge.code, edge.is_step);
        } else if (search_from(edge.target)) {
          if (result_.trace) put_in_front(way_to(reached, at, edge));
          return;
        }
      }
      if (!may_go_on_here()) return;
    }
  }

  Trace way_to(const std::vector<Reached>& reached, std::size_t at, const Edge& last) const {
    Trace way;
    if (last.is_step) way.steps.push_back(graph_.steps().undo(last.target, last.code).step);
    for (; at != 0; at = reached[at].before) {
      if (!reached[at].is_step) continue;
      way.steps.push_back(graph_.steps().undo(reached[at].node, reached[at].code).step);
    }
    std::ranges::reverse(way.steps);
    return way;
  }

  void put_in_front(Trace way) {
    Trace& trace = *result_.trace;
    if (trace.loop_start) *trace.loop_start += way.steps.size();
    trace.steps.insert(trace.steps.begin(), way.steps.begin(), way.steps.end());
    way_ = std::move(way);
  }

  bool is_mine(std::uint32_t monitor_state) const {
    return part_ == nullptr || graph_.monitor().part_of(monitor_state) == part_->number;
  }
  bool may_wait() const {
    const Monitor& monitor = graph_.monitor();
    if (part_ == nullptr) return monitor.may_wait();
    for (std::uint32_t at = 0; at < monitor.states(); ++at) {
      if (is_mine(at) && monitor.is_waiting(at)) return true;
    }
    return false;
  }

  void search_from_roots() {
    constexpr std::size_t together = 32;  // fetched ahead
    std::vector<State> entries;
    const auto search_all = [&] {
      for (const State& node : entries) {
        if (!is_over_) search_from(node);
      }
      entries.clear();
    };
    part_->reached.table().for_each([&](const State& state, std::uint64_t) {
      if (is_over_ || graph_.system().is_error(state)) return;
      graph_.for_each_entry(state, part_->number, [&](const State& node) {
        graph_.prefetch(graph_.address_of(node));
        entries.push_back(node);
      });
      if (entries.size() >= together) search_all();
    });
    search_all();
  }

  // Tells the searches of the other parts how many bytes this one takes now.
  void tell(std::uint64_t bytes_now) {
    auto& shared = part_->shared;
    shared.states += graph_.size() - told_states_;
    told_states_ = graph_.size();
    const std::uint64_t all = shared.bytes += bytes_now - told_bytes_;
    told_bytes_ = bytes_now;
    result_.bytes = std::max(result_.bytes, all);
  }

  bool may_go_on_here() {
    if (graph_.size() >= budget_) {
      is_over_budget_ = true;
      return false;
    }
    if (graph_.size() % limit_interval != 0) return true;
    if (part_ == nullptr) {
      return may_go_on(limits_, graph_.size(), bytes(), growth_bytes(), result_);
    }
    auto& shared = part_->shared;
    if (shared.least_found < part_->number) {
      result_.end = SearchResult::End::stopped;
      return false;
    }
    tell(bytes());
    return may_go_on(limits_, shared.states, shared.bytes, shared.threads * growth_bytes(),
                     result_);
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
    if (frames_.empty()) entry_ = number;
    frames_.push({number, 0});
    result_.depth = std::max<std::uint64_t>(result_.depth, frames_.size());
    if (graph_.monitor_state(node) == graph_.monitor().universal()) {
      found({number}, [at = number](FairLasso<Graph>& lasso) { return lasso.prefix_to({at}); });
      return true;
    }
    expand(edge);
    if (!is_over_ && !may_go_on_here()) is_over_ = true;
    return true;
  }

  // Edges to known nodes are looked at now, the others are put aside.
  void expand(const Open& incoming) {
    const State& node = incoming.target;
    graph_.find_steps(node, steps_);
    successors_.clear();
    if (is_waiting(node)) {
      const auto last = static_cast<std::uint32_t>(lowest_word(incoming.marks_or_last));
      find_successors(node, {0, &*order_, (*order_)[last]});
    } else {
      find_reduced_successors(node);
    }
    const bool waits = is_waiting(node);
    // Which are left out depends on how the search came to the node.
    result_.transitions += waits ? steps_.seen : successors_.size();
    for (const Successor& successor : successors_) {
      const Edge& edge = successor.edge;
      if (successor.number == Graph::no_node) {
        open_.push({edge.target, marks_or_last(node, edge)});
        ++frames_.top().open;
      } else {
        merge(successor.number, waits ? Bits{} : edge.marks);
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

  // Which steps are followed: those of some programs, or those that another step does not leave
  // out.
  struct Wanted {
    std::uint64_t programs = ~std::uint64_t{0};  // the first 64; all others are wanted
    const StepOrder* order = nullptr;
    StepOrder::Last last{};
    bool operator()(const Step& step) const {
      if (order != nullptr) {
        return step.program >= last.program || !order->leaves_out(last, step.program, step.edge);
      }
      return step.program >= most_actors_in_a_word || (programs >> step.program & 1) != 0;
    }
  };

  void find_reduced_successors(const State& node) {
    if (sets_ == nullptr) return find_successors(node, {});
    const std::uint64_t programs = sets_->select(graph_.plain(node));
    if (!sets_->is_reduced()) return find_successors(node, {});
    find_successors(node, {programs});
    if (std::ranges::any_of(successors_, [&](const Successor& successor) {
          return successor.number != Graph::no_node && is_on_path_[successor.number];
        })) {
      find_successors(node, {~programs});
    }
  }

  // Appends the edges by the steps that are wanted.
  void find_successors(const State& node, const Wanted& wanted) {
    const std::size_t first = successors_.size();
    graph_.for_each_wanted_edge(node, steps_, wanted, [&](const Edge& edge) {
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
    if (!graph_.is_accepted(roots_.top().marks) || graph_.wants_more()) return;
    std::vector<Number> members = members_from(roots_.top().first_active);
    if (!graph_.has_pairs()) return found_round({std::move(members), {}});
    // An edge between two of them that was not taken yet may ask more.
    graph_.list_nodes();
    check_whole(std::move(members));
    MAIDE_CHECK(is_over_);
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
    if ((graph_.wants_more() || graph_.has_pairs()) && root.has_edge && root.may_accept &&
        graph_.has_all(root.marks)) {
      graph_.list_nodes();
      check_whole(members_from(root.first_active));
    }
    for (std::size_t i = root.first_active; i < active_.size(); ++i) is_dead_[active_[i]] = true;
    active_.shrink_to(root.first_active);
  }

  // Under strong fairness, and with a pair that is not answered, a component is looked at once it
  // is complete.
  void check_whole(std::vector<Number> members) {
    FairParts<Graph> parts(graph_, limits_.control);
    if (const auto part = parts.find({std::move(members), {}})) found_round(*part);
  }

  void found_round(const FairPart<Graph>& part) {
    found(part.members, [&](FairLasso<Graph>& lasso) { return lasso.run_round(part); });
  }

  // There is a violation; `run(lasso)` makes the run that is shown, by way of the members.
  template <typename Run>
  void found(const std::vector<Number>& members, Run&& run) {
    is_over_ = true;
    result_.has_violation = true;
    if (part_ != nullptr) {
      auto& least = part_->shared.least_found;
      std::uint32_t before = least;
      while (part_->number < before && !least.compare_exchange_weak(before, part_->number)) {
      }
    }
    graph_.list_nodes();
    typename FairLasso<Graph>::Set first;
    if (part_ != nullptr) {
      const Number entry = nearest_entry(members);
      way_ = part_->reached.run_to(graph_.plain(graph_.node(entry)));
      first.push_back(entry);
    } else if (way_) {
      first.push_back(entry_);
    }
    FairLasso<Graph> lasso(graph_, limits_.control, std::move(first));
    const std::uint64_t most = bytes() + lasso.bytes(graph_);
    if (part_ != nullptr) tell(most);
    result_.bytes = std::max(result_.bytes, most);
    result_.trace = run(lasso);
    if (way_) put_in_front(*way_);
    result_.end = SearchResult::End::found;
  }

  // A member to which a root goes at once, with a short way there; where there is none, the node at
  // which the search came into this part.
  Number nearest_entry(const std::vector<Number>& members) const {
    constexpr std::size_t most_looked_at = std::size_t{1} << 10;
    Number best = entry_;
    std::size_t length = ~std::size_t{0};
    for (std::size_t i = 0; i < std::min(members.size(), most_looked_at); ++i) {
      const State& node = graph_.node(members[i]);
      const State state = graph_.plain(node);
      bool is_entry = false;
      graph_.for_each_entry(state, part_->number,
                            [&](const State& one) { is_entry = is_entry || one == node; });
      if (!is_entry) continue;
      const std::size_t own = part_->reached.run_to(state).steps.size();
      if (own < length) {
        length = own;
        best = members[i];
      }
    }
    return best;
  }

  Graph graph_;
  const SearchLimits& limits_;
  StubbornSets* sets_;
  std::uint64_t budget_;
  const Part* part_;
  std::optional<Trace> way_;  // to where the search began, if that is no first node
  bool is_over_budget_ = false;
  std::uint64_t told_states_ = 0, told_bytes_ = 0;  // to the searches of other parts
  Number entry_ = 0;                                // at the path's beginning
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

// What was reached is a node with each root, but for errors. `result`: of that search, on all
// ranks.
template <std::size_t words>
void count_roots(const PackedSystem& system, const BreadthFirstSearch<words>& reached,
                 std::uint64_t roots, SearchResult& result, Ranks* ranks = nullptr) {
  if (system.has_errors()) {
    RankReport errors;
    reached.table().for_each([&](const PackedState<words>& state, std::uint64_t) {
      if (system.is_error(state)) ++errors.states;
    });
    if (ranks != nullptr) errors = sum_of(RankBatches<std::uint64_t>(*ranks).exchange(errors));
    result.states -= errors.states;
  }
  result.states *= roots;
  result.transitions *= roots;
  result.has_cut = false;
}

// By one thread: nothing if the product is large, and a violation is not soon found.
template <std::size_t words, typename Monitor>
std::optional<SearchResult> search_small(const PackedSystem& system, const Monitor& monitor,
                                         const SearchLimits& limits) {
  const std::uint64_t budget = limits.states_a_thread * limits.states_a_thread;
  FairCycleSearch<words, Monitor> search(system, monitor, limits, nullptr, budget);
  SearchResult result = search.run();
  if (search.is_over_budget()) return std::nullopt;
  return result;
}

// Searches the parts of a product beside each other, with all steps taken; a small product, or one
// with a violation near the start, by one thread whole.
template <std::size_t words, typename Monitor>
class PartsSearch {
 public:
  // Keeps references. `system` as above.
  PartsSearch(const PackedSystem& system, const Monitor& monitor, const SearchLimits& limits)
      : system_(system), monitor_(monitor), limits_(limits) {
    for (std::uint32_t at = 0; at < monitor.states(); ++at) roots_ += monitor.is_root(at) ? 1 : 0;
  }

  // Whether there is work for several threads.
  bool pays() const { return roots_ > 0 || monitor_.parts() > 1; }

  SearchResult run() {
    if (auto small = search_small<words>(system_, monitor_, limits_)) return std::move(*small);
    SearchLimits limits = limits_;
    limits.ranks = nullptr;
    const StepOrder order(system_);
    BreadthFirstOptions options(limits);
    options.order = &order;
    Reached reached(system_, limits, options);
    SearchResult result;
    if (roots_ > 0) {
      result = reached.run();
      if (result.end != SearchResult::End::complete) return result;
      count_roots(system_, reached, roots_, result);
    }
    search_parts(reached, result);
    return result;
  }

 private:
  using Part = ProductPart<words>;
  using Reached = typename Part::Reached;

  void search_parts(const Reached& reached, SearchResult& result) const {
    const std::uint32_t parts = monitor_.parts();
    ThreadTeam team(std::min<unsigned>(limits_.threads, std::max(parts, 1U)));
    typename Part::Shared shared(team.size());
    shared.states = result.states;
    shared.bytes = reached.bytes();
    std::vector<SearchResult> results(parts);
    std::atomic<std::uint32_t> next = 0;
    const auto work = [&](unsigned member) {
      SearchLimits limits = limits_;
      if (member != 0) limits.control.progress = nullptr;
      for (std::uint32_t number = next++; number < parts; number = next++) {
        if (shared.least_found < number) return;
        const Part part{reached, number, shared};
        results[number] =
            FairCycleSearch<words, Monitor>(system_, monitor_, limits, nullptr,
                                            FairCycleSearch<words, Monitor>::no_budget, &part)
                .run();
      }
    };
    if (team.size() == 1) {
      work(0);
    } else {
      team.run(work);
    }
    add_up(results, shared.least_found, result);
  }

  // The violation of the least part is shown; of those behind it nothing is counted.
  static void add_up(std::vector<SearchResult>& results, std::uint32_t least_found,
                     SearchResult& sum) {
    for (std::uint32_t number = 0; number < results.size() && number <= least_found; ++number) {
      SearchResult& one = results[number];
      sum.states += one.states;
      sum.transitions += one.transitions;
      sum.depth = std::max(sum.depth, one.depth);
      sum.bytes = std::max(sum.bytes, one.bytes);
      if (one.end == SearchResult::End::complete) continue;
      sum.end = one.end;
      sum.has_violation = one.has_violation;
      sum.trace = std::move(one.trace);
    }
  }

  const PackedSystem& system_;
  const Monitor& monitor_;
  const SearchLimits& limits_;
  std::uint64_t roots_ = 0;
};

}  // namespace maide
