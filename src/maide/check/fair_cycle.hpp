// On-the-fly search for a run that something watches and accepts: a cycle in the product of a
// system and a monitor that has every mark, after Couvreur, "On-the-fly verification of linear
// temporal logic", FM 1999 (Tarjan's components, merged with their marks as they are found). A
// generalised Buchi automaton is such a monitor, and so is "this program never steps again";
// fairness is more marks.
//
// A monitor says what may follow in the middle of the search:
//   std::size_t states() const;            0..states()-1
//   unsigned marks() const;                at most 64
//   std::uint32_t universal() const;       a state in which every run is accepted, or no state
//   bool is_strong() const;                programs that can step again and again on the cycle do
//   void start(state, follow)              calls follow(monitor state, marks) for the initial state
//   void step(next, program, edge, enabled programs, monitor state, follow)
//   void stay(state, monitor state, follow)     nothing can happen any more; may follow nothing
// The marks of what start() follows count for nothing: no cycle passes there. `enabled programs`:
// those that could step instead, by bit; at most 64 programs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "maide/check/explorer.hpp"
#include "maide/check/packed_system.hpp"
#include "maide/check/trace.hpp"

namespace maide {

inline constexpr std::uint32_t no_monitor_state = ~std::uint32_t{0};
// Marks of a monitor, and programs of a system: bits of a word. Who asks for more is refused.
inline constexpr unsigned most_marks = 64;
// Of a product's nodes, in the table.
inline constexpr unsigned node_number_bits = 32;

template <std::size_t words, typename Monitor>
class FairCycleSearch {
 public:
  using State = PackedState<words>;

  // `system` was made with node_number_bits of payload and the monitor's states.
  FairCycleSearch(const PackedSystem& system, const Monitor& monitor, const SearchLimits& limits)
      : system_(system),
        monitor_(monitor),
        limits_(limits),
        all_marks_(monitor.marks() == 64 ? ~std::uint64_t{0}
                                         : (std::uint64_t{1} << monitor.marks()) - 1),
        table_(system.address_bits(), node_number_bits) {
    if (monitor.marks() > most_marks || system.program_count() > most_marks) {
      throw std::logic_error("too many marks or programs for a search for fair cycles");
    }
  }

  SearchResult run() {
    try {
      search();
    } catch (const std::bad_alloc&) {
      result_.end = SearchResult::End::out_of_memory;
    }
    result_.states = nodes_.size();
    result_.bytes = std::max(result_.bytes, bytes());
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t unseen = ~std::uint32_t{0};  // no node has this number,
  static constexpr std::uint32_t no_parent = unseen - 1;      // nor this one
  static constexpr std::size_t check_interval = 1 << 14;

  struct Edge {
    State target;
    std::uint64_t marks = 0;
    std::uint64_t code = 0;  // of the step
    bool is_step = false;    // else the run stays where it is
  };
  struct Frame {
    std::uint32_t node = 0;
    std::size_t first_edge = 0;  // in edges_; the next to be taken is the last
  };
  struct Root {
    std::uint32_t node = 0;
    std::uint64_t marks = 0;     // inside the component
    std::uint64_t incoming = 0;  // of the edge by which it was entered
  };

  std::uint64_t bytes() const {
    return table_.peak_bytes() + nodes_.capacity() * sizeof(State) + is_dead_.capacity() / 8 +
           frames_.capacity() * sizeof(Frame) + edges_.capacity() * sizeof(Edge) +
           (active_.capacity() + roots_.capacity() * 6) * sizeof(std::uint32_t);
  }

  // Calls `visit(edge)` for everything that may follow a node.
  template <typename Visit>
  void for_each_edge(const State& node, Visit&& visit) const {
    const std::uint32_t watching = system_.monitor().get(node);
    State plain = node;
    system_.monitor().set(plain, 0);
    const std::uint64_t enabled = enabled_programs(plain);
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      if ((enabled >> program & 1) == 0) continue;
      system_.for_each_step(
          plain, program,
          [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
            if (is_cut) return;
            monitor_.step(next, program, edge, enabled, watching,
                          [&](std::uint32_t state, std::uint64_t marks) {
                            State target = next;
                            system_.monitor().set(target, state);
                            visit(Edge{target, marks, code, true});
                          });
          });
    }
    if (enabled != 0) return;
    monitor_.stay(plain, watching, [&](std::uint32_t state, std::uint64_t marks) {
      State target = plain;
      system_.monitor().set(target, state);
      visit(Edge{target, marks, 0, false});
    });
  }

  std::vector<State> first_nodes() const {
    std::vector<State> nodes;
    const State initial = system_.pack<words>(initial_state(system_.system()));
    monitor_.start(initial, [&](std::uint32_t state, std::uint64_t) {
      State node = initial;
      system_.monitor().set(node, state);
      nodes.push_back(node);
    });
    return nodes;
  }

  void search() {
    for (const State& node : first_nodes()) {
      if (!enter(node, 0)) continue;
      if (is_over_ || search_from_top()) return;
    }
  }

  // True if the search is over.
  bool search_from_top() {
    while (!frames_.empty()) {
      Frame& frame = frames_.back();
      if (edges_.size() == frame.first_edge) {
        leave();
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
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    const auto insertion = table_.insert(node, number);
    if (!insertion.is_new) {
      known_ = static_cast<std::uint32_t>(insertion.payload);
      return false;
    }
    nodes_.push_back(node);
    is_dead_.push_back(false);
    if (nodes_.size() == no_parent) throw std::bad_alloc();
    active_.push_back(number);
    roots_.push_back({number, 0, incoming});
    frames_.push_back({number, edges_.size()});
    for_each_edge(node, [&](const Edge& edge) { edges_.push_back(edge); });
    result_.depth = std::max<std::uint64_t>(result_.depth, frames_.size());
    if (nodes_.size() % check_interval == 0) check_limits();
    if (system_.monitor().get(node) == monitor_.universal()) {
      is_over_ = true;
      result_.end = SearchResult::End::found;
      result_.trace = prefix_to({number});
    }
    return true;
  }

  void check_limits() {
    result_.bytes = std::max(result_.bytes, bytes());
    limits_.control.report({"checking", nodes_.size(), 0, 0, 0, 0});
    if (limits_.control.should_stop()) {
      result_.end = SearchResult::End::stopped;
      is_over_ = true;
    } else if (bytes() + table_.growth_bytes() > limits_.bytes) {
      result_.end = SearchResult::End::out_of_memory;
      is_over_ = true;
    }
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
    if (roots_.back().marks != all_marks_ || monitor_.is_strong()) return;
    is_over_ = true;
    result_.end = SearchResult::End::found;
    const auto first = std::lower_bound(active_.begin(), active_.end(), roots_.back().node);
    show({first, active_.end()});
  }

  // The top has no more edges.
  void leave() {
    const std::uint32_t node = frames_.back().node;
    frames_.pop_back();
    if (roots_.back().node != node) return;
    const bool has_all = roots_.back().marks == all_marks_;
    roots_.pop_back();
    const auto first = std::lower_bound(active_.begin(), active_.end(), node);
    if (monitor_.is_strong() && has_all) check_whole({first, active_.end()});
    for (auto member = first; member != active_.end(); ++member) is_dead_[*member] = true;
    active_.erase(first, active_.end());
  }

  // ---- strong fairness: components are looked at once they are complete ----

  // Looks for a part of a strongly connected set that is accepted: a program that can step there
  // and never does is not treated fairly, so the states where it can are left out (Emerson & Lei,
  // "Modalities for model checking", Sci. Comput. Program. 1987).
  void check_whole(std::vector<std::uint32_t> members) {
    std::vector<std::vector<std::uint32_t>> open{std::move(members)};
    while (!open.empty() && !is_over_) {
      const std::vector<std::uint32_t> set = std::move(open.back());
      open.pop_back();
      std::uint64_t marks = 0, enabled = 0, stepped = 0;
      bool has_edge = false;
      for (const std::uint32_t member : set) {
        enabled |= enabled_programs(nodes_[member]);
        for_each_edge_within(set, member, [&](const Edge& edge, std::uint32_t) {
          has_edge = true;
          marks |= edge.marks;
          if (edge.is_step) stepped |= std::uint64_t{1} << program_of(edge);
        });
      }
      if (!has_edge || marks != all_marks_) continue;
      const std::uint64_t starved = enabled & ~stepped;
      if (starved == 0) {
        is_over_ = true;
        result_.end = SearchResult::End::found;
        show(set);
        return;
      }
      std::vector<std::uint32_t> rest;
      for (const std::uint32_t member : set) {
        if ((enabled_programs(nodes_[member]) & starved) == 0) rest.push_back(member);
      }
      for (auto& component : components_of(rest)) open.push_back(std::move(component));
    }
  }

  std::uint64_t enabled_programs(const State& node) const {
    std::uint64_t enabled = 0;
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      system_.for_each_step(node, program, [&](const State&, std::uint32_t, bool, std::uint64_t) {
        enabled |= std::uint64_t{1} << program;
      });
    }
    return enabled;
  }

  std::uint32_t program_of(const Edge& edge) const {
    return system_.undo(system_.unpack(edge.target), edge.code).step.program;
  }

  // `set` is sorted. Visits the edges from `member` that stay in it, and where they lead.
  template <typename Visit>
  void for_each_edge_within(const std::vector<std::uint32_t>& set, std::uint32_t member,
                            Visit&& visit) const {
    for_each_edge(nodes_[member], [&](const Edge& edge) {
      std::uint64_t target = 0;
      if (!table_.find(edge.target, target)) return;
      const auto number = static_cast<std::uint32_t>(target);
      if (std::binary_search(set.begin(), set.end(), number)) visit(edge, number);
    });
  }

  // Tarjan's components of a set of nodes, each sorted (iterative; SIAM J. Comput. 1972).
  std::vector<std::vector<std::uint32_t>> components_of(
      const std::vector<std::uint32_t>& set) const {
    const auto place_of = [&](std::uint32_t number) {
      return static_cast<std::size_t>(std::lower_bound(set.begin(), set.end(), number) -
                                      set.begin());
    };
    std::vector<std::vector<std::uint32_t>> result;
    std::vector<std::uint32_t> low(set.size(), 0), order(set.size(), 0);
    std::vector<bool> is_active(set.size());
    std::vector<std::size_t> active;
    std::vector<std::pair<std::size_t, std::vector<std::size_t>>> path;
    std::uint32_t count = 0;
    const auto enter_place = [&](std::size_t place) {
      order[place] = low[place] = ++count;
      is_active[place] = true;
      active.push_back(place);
      std::vector<std::size_t> targets;
      for_each_edge_within(set, set[place], [&](const Edge&, std::uint32_t target) {
        targets.push_back(place_of(target));
      });
      path.emplace_back(place, std::move(targets));
    };
    for (std::size_t start = 0; start < set.size(); ++start) {
      if (order[start] == 0) enter_place(start);
      while (!path.empty()) {
        const std::size_t place = path.back().first;
        if (!path.back().second.empty()) {
          const std::size_t target = path.back().second.back();
          path.back().second.pop_back();
          if (order[target] == 0) {
            enter_place(target);
          } else if (is_active[target]) {
            low[place] = std::min(low[place], order[target]);
          }
          continue;
        }
        path.pop_back();
        if (!path.empty()) {
          const std::size_t parent = path.back().first;
          low[parent] = std::min(low[parent], low[place]);
        }
        if (low[place] != order[place]) continue;
        auto& component = result.emplace_back();
        std::size_t member = 0;
        do {
          member = active.back();
          active.pop_back();
          is_active[member] = false;
          component.push_back(set[member]);
        } while (member != place);
        std::sort(component.begin(), component.end());
      }
    }
    return result;
  }

  // ---- what is shown ----

  Step step_of(const Edge& edge) const {
    return system_.undo(system_.unpack(edge.target), edge.code).step;
  }

  // A shortest run, in nodes that the search knows, to one of `goals` (sorted).
  Trace prefix_to(const std::vector<std::uint32_t>& goals, std::uint32_t* reached = nullptr) const {
    std::vector<std::uint32_t> first;
    for (const State& node : first_nodes()) {
      std::uint64_t number = 0;
      if (table_.find(node, number)) first.push_back(static_cast<std::uint32_t>(number));
    }
    std::vector<Edge> path;
    const std::uint32_t end = shortest_path(
        first, nullptr,
        [&](std::uint32_t node) { return std::binary_search(goals.begin(), goals.end(), node); },
        path);
    if (reached != nullptr) *reached = end;
    Trace trace;
    for (const Edge& edge : path) {
      if (edge.is_step) trace.steps.push_back(step_of(edge));
    }
    return trace;
  }

  // From one of `first` to a node that `is_goal`; of a path without edges the first one. Appends
  // the edges to `path`; keeps within `set` if there is one.
  template <typename IsGoal>
  std::uint32_t shortest_path(const std::vector<std::uint32_t>& first,
                              const std::vector<std::uint32_t>* set, IsGoal&& is_goal,
                              std::vector<Edge>& path) const {
    std::vector<std::uint32_t> parents(nodes_.size(), unseen);
    std::vector<std::uint32_t> queue;
    for (const std::uint32_t node : first) {
      if (parents[node] == unseen) queue.push_back(node);
      parents[node] = no_parent;
    }
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const std::uint32_t node = queue[at];
      if (is_goal(node)) {
        std::vector<Edge> backwards;
        for (std::uint32_t back = node; parents[back] != no_parent; back = parents[back]) {
          backwards.push_back(edge_between(parents[back], back));
        }
        path.insert(path.end(), backwards.rbegin(), backwards.rend());
        return node;
      }
      for_each_edge(nodes_[node], [&](const Edge& edge) {
        std::uint64_t target = 0;
        if (!table_.find(edge.target, target)) return;
        const auto number = static_cast<std::uint32_t>(target);
        if (parents[number] != unseen) return;
        if (set != nullptr && !std::binary_search(set->begin(), set->end(), number)) return;
        parents[number] = node;
        queue.push_back(number);
      });
    }
    throw std::logic_error("the search lost a node");
  }

  Edge edge_between(std::uint32_t from, std::uint32_t to) const {
    std::optional<Edge> found;
    for_each_edge(nodes_[from], [&](const Edge& edge) {
      if (!found && edge.target == nodes_[to]) found = edge;
    });
    return found.value();
  }

  // A run into the component, and round in it past every mark - and, with strong fairness, a step
  // of every program that can step there.
  void show(const std::vector<std::uint32_t>& members) {
    std::uint32_t start = 0;
    Trace trace = prefix_to(members, &start);
    std::vector<Edge> loop;
    std::uint64_t marks = 0, stepped = 0;
    std::uint64_t wanted = 0;
    if (monitor_.is_strong()) {
      for (const std::uint32_t member : members) wanted |= enabled_programs(nodes_[member]);
    }
    std::uint32_t at = start;
    const auto take = [&](const Edge& edge) {
      loop.push_back(edge);
      marks |= edge.marks;
      if (edge.is_step) stepped |= std::uint64_t{1} << program_of(edge);
    };
    const auto is_useful = [&](const Edge& edge) {
      return (edge.marks & ~marks) != 0 ||
             (edge.is_step && ((std::uint64_t{1} << program_of(edge)) & wanted & ~stepped) != 0);
    };
    // At least one edge, and then whatever is missing; then home.
    while (loop.empty() || marks != all_marks_ || (wanted & ~stepped) != 0) {
      std::optional<Edge> next;
      std::uint32_t target = 0;
      std::vector<Edge> path;
      const bool any = loop.empty() && marks == all_marks_ && (wanted & ~stepped) == 0;
      at = shortest_path(
          {at}, &members,
          [&](std::uint32_t node) {
            for_each_edge_within(members, node, [&](const Edge& edge, std::uint32_t to) {
              if (!next && (any || is_useful(edge))) {
                next = edge;
                target = to;
              }
            });
            return next.has_value();
          },
          path);
      for (const Edge& edge : path) take(edge);
      take(*next);
      at = target;
    }
    std::vector<Edge> home;
    shortest_path(
        {at}, &members, [&](std::uint32_t node) { return node == start; }, home);
    for (const Edge& edge : home) take(edge);
    const std::size_t loop_start = trace.steps.size();
    for (const Edge& edge : loop) {
      if (edge.is_step) trace.steps.push_back(step_of(edge));
    }
    if (trace.steps.size() > loop_start) trace.loop_start = loop_start;
    result_.trace = std::move(trace);
  }

  const PackedSystem& system_;
  const Monitor& monitor_;
  const SearchLimits& limits_;
  std::uint64_t all_marks_;
  StateTable<words> table_;
  std::vector<State> nodes_;  // by number, in the order of discovery
  std::vector<bool> is_dead_;
  std::vector<Frame> frames_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> active_;  // nodes of components that are not complete, ascending
  std::vector<Root> roots_;
  std::uint32_t known_ = 0;  // the node that enter() found
  bool is_over_ = false;
  SearchResult result_;
};

}  // namespace maide
