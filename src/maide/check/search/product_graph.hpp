// The product of a system and a monitor, as far as a search has seen it: its nodes by number, and
// what may follow each. A monitor watches a run; it says what may follow in the middle of the
// search:
//   std::size_t states() const;            0..states()-1
//   Bits                                   of programs, marks and groups: std::uint64_t or WideBits
//   unsigned marks() const;                The marks that a cycle must have.
//   unsigned pairs() const;                Streett pairs. Behind the marks that a cycle must have
//                                          each has two: it is answered, and it is asked. A cycle
//                                          on which a pair is asked must have its answer. All marks
//                                          together are at most as many as Bits has.
//   std::uint32_t universal() const;       a state in which every run is accepted, or no state
//   bool is_strong() const;                On the cycle, fair programs that can step again and
//                                          again do.
//   Bits fair_programs() const;            The programs of which it asks that.
//   Bits groups() const;                   The fair groups of which it asks that.
//   bool is_waiting(state) const;          It may stay there, whatever happens. No cycle with every
//                                          mark passes there. Where it goes to depends on the
//                                          system's next state alone.
//   bool may_wait() const;                 in any state
//   bool is_root(state) const;             it waits there, may begin there, and comes there from
//                                          nowhere else
//   std::uint32_t parts() const;           of its other states, between which nothing leads
//   std::uint32_t part_of(state) const;    no_part of a root
//   void start(state, follow)              calls follow(monitor state, marks) for the initial state
//   void step(next, program, edge, enabled programs, monitor state, follow)
//   void stay(state, monitor state, follow)     nothing can happen any more; may follow nothing
// The marks of what start() follows count for nothing: no cycle passes there. `enabled programs`:
// those that could step instead, by bit. With marks for weak fairness those
// that could not in the middle of the step, which is a call, are left out.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/packed/bits.hpp"
#include "maide/check/packed/packed_steps.hpp"

namespace maide {

inline constexpr std::uint32_t no_monitor_state = ~std::uint32_t{0};
inline constexpr std::uint32_t no_part = ~std::uint32_t{0};
// Bits of the number of a product's node, in the table.
inline constexpr unsigned node_number_bits = 32;

// Who can do something, or does: actors and fair groups, by bit.
template <typename Bits>
struct Share {
  Bits programs{}, groups{};
  bool is_empty() const { return is_none(programs) && is_none(groups); }
  Share operator|(const Share& other) const {
    return {programs | other.programs, groups | other.groups};
  }
  Share operator&(const Share& other) const {
    return {programs & other.programs, groups & other.groups};
  }
  Share without(const Share& other) const {
    return {programs & ~other.programs, groups & ~other.groups};
  }
};

template <std::size_t words, typename Monitor>
class ProductGraph {
 public:
  using State = PackedState<words>;
  using Bits = typename Monitor::Bits;
  using Share = maide::Share<Bits>;
  using Number = std::uint32_t;
  static constexpr Number no_node = ~Number{0};  // nor has a node the number before

  struct Edge {
    State target;
    Bits marks{};
    std::uint32_t code = 0;  // of the step
    std::uint32_t edge = 0;  // of the program
    std::uint16_t program = 0;
    bool is_step = false;  // else the run stays where it is
  };
  // What programs can do in a node's state of the system, before the monitor is asked.
  struct Steps {
    struct One {
      State next;
      std::uint32_t edge = 0;
      std::uint32_t code = 0;
      std::uint16_t program = 0;
    };
    std::vector<One> steps;  // but for those that cut the run, or come to an error
    Bits enabled{};          // actors that can make progress by themselves, those steps among them
    bool is_over = true;     // no step is progress
    Bits groups{};           // fair groups of which a step is possible
    std::uint64_t seen = 0;  // steps, those that are not among `steps` included
  };

  // `system` was made with node_number_bits of payload and the monitor's states.
  ProductGraph(const PackedSystem& system, const Monitor& monitor)
      : system_(system),
        steps_(system),
        monitor_(monitor),
        table_(system.address_bits(), node_number_bits, std::min(words, system.words())) {
    const std::size_t marks = monitor.marks() + std::size_t{2} * monitor.pairs();
    if (std::max<std::size_t>(marks, steps_.actors()) > bit_count_of<Bits>) {
      throw std::logic_error("too many marks or programs for a search for fair cycles");
    }
    for (std::size_t pair = 0; pair < monitor.pairs(); ++pair) {
      asks_ |= bit_of<Bits>(monitor.marks() + 2 * pair + 1);
    }
  }

  const PackedSystem& system() const { return system_; }
  const PackedSteps<words>& steps() const { return steps_; }
  const Monitor& monitor() const { return monitor_; }
  // That a cycle must have.
  Bits all_marks() const { return first_bits<Bits>(monitor_.marks()); }
  bool has_all(const Bits& marks) const { return is_none(all_marks() & ~marks); }
  // Pairs are sets of the marks by which they are asked.
  bool has_pairs() const { return monitor_.pairs() != 0; }
  const Bits& all_asks() const { return asks_; }
  Bits asked(const Bits& marks) const { return marks & asks_; }
  Bits without_asked(const Bits& marks) const { return marks & ~asks_; }
  Bits answered(const Bits& marks) const { return moved_up(marks & ~asks_, 1) & asks_; }
  Bits unanswered(const Bits& marks) const { return asked(marks) & ~answered(marks); }
  // What a cycle with these marks needs of marks.
  bool is_accepted(const Bits& marks) const { return has_all(marks) && is_none(unanswered(marks)); }
  std::size_t size() const { return table_.size(); }
  std::uint32_t monitor_state(const State& node) const { return system_.monitor().get(node); }

  // The node's number; a new node gets the next one. Throws std::bad_alloc.
  struct Insertion {
    Number number = 0;
    bool is_new = false;
  };
  Insertion insert(const State& node) {
    const auto number = static_cast<Number>(size());
    if (number >= no_node - 1) throw std::bad_alloc();
    const auto insertion = table_.insert(node, number);
    MAIDE_CHECK(insertion.is_new ? insertion.payload == number : insertion.payload < number);
    if (insertion.is_new && lists_nodes_) nodes_.push_back(node);
    return {static_cast<Number>(insertion.payload), insertion.is_new};
  }
  // no_node if it is not known.
  Number find(const State& node) const { return find(node, address_of(node)); }
  using Address = typename StateTable<words>::Address;
  Number find(const State& node, const Address& address) const {
    std::uint64_t number = 0;
    return table_.find(node, address, number) ? static_cast<Number>(number) : no_node;
  }
  Address address_of(const State& node) const { return table_.address_of(node); }
  // Ahead of a find() or insert().
  void prefetch(const Address& address) const { table_.prefetch(address); }

  // The table tells nodes' numbers; the other way round takes a list, which is made when it is
  // first needed: O(nodes). Before that, node(), able() and for_each_edge() by number
  // are not to be called.
  void list_nodes() {
    if (lists_nodes_) return;
    nodes_.resize(size());
    table_.for_each([&](const State& node, std::uint64_t number) { nodes_[number] = node; });
    lists_nodes_ = true;
  }
  const State& node(Number number) const {
    MAIDE_CHECK(lists_nodes_ && number < nodes_.size());
    return nodes_[number];
  }

  State plain(const State& node) const {
    State plain = node;
    system_.monitor().set(plain, 0);
    return plain;
  }
  void find_steps(const State& node, Steps& found) const {
    if (system_.has_plain_steps_only()) {
      find_steps_as<true>(node, found);
    } else {
      find_steps_as<false>(node, found);
    }
  }
  // Who could step in the node's state, of those that the monitor wants to do so on the cycle.
  Share able(Number number) const {
    find_steps(node(number), scratch_);
    return Share{scratch_.enabled, scratch_.groups} & wanted();
  }
  // Who steps by the edge.
  Share share_of(const Edge& edge) const {
    if (!edge.is_step) return {};
    const bool is_own = system_.is_own(edge.program, edge.edge);
    return {is_own ? bit_of<Bits>(edge.program) : Bits{},
            system_.template group_of<Bits>(edge.program, edge.edge)};
  }
  Share wanted() const {
    return {monitor_.is_strong() ? monitor_.fair_programs() : Bits{}, monitor_.groups()};
  }
  // The monitor wants more of a cycle than its marks.
  bool wants_more() const { return !wanted().is_empty(); }

  // Calls `visit(edge)` for what may follow the node by the steps for which `is_wanted(step)`, or
  // by none at all.
  template <typename IsWanted, typename Visit>
  void for_each_wanted_edge(const State& node, const Steps& found, IsWanted&& is_wanted,
                            Visit&& visit) const {
    const std::uint32_t watching = system_.monitor().get(node);
    const bool looks_into_calls = system_.has_calls() && !monitor_.is_strong();
    for (const auto& step : found.steps) {
      if (!is_wanted(step)) continue;
      Bits enabled = found.enabled;
      if (looks_into_calls) {
        enabled &= ~system_.template locked_out<Bits>(node, step.program, step.edge);
      }
      monitor_.step(step.next, step.program, step.edge, enabled, watching,
                    [&](std::uint32_t state, const Bits& marks) {
                      State target = step.next;
                      system_.monitor().set(target, state);
                      visit(Edge{target, marks, step.code, step.edge, step.program, true});
                    });
    }
    if (!found.is_over) return;
    monitor_.stay(plain(node), watching, [&](std::uint32_t state, const Bits& marks) {
      State target = node;
      system_.monitor().set(target, state);
      visit(Edge{target, marks, 0, 0, 0, false});
    });
  }
  // Everything that may follow. Not to be nested.
  template <typename Visit>
  void for_each_edge(Number number, Visit&& visit) const {
    for (const Edge& edge : edges_of(nodes_[number])) visit(edge);
  }
  // The node's edges, as a list that lasts until edges of a node are next asked for; `seen`: the
  // steps that were looked at.
  const std::vector<Edge>& edges_of(const State& node, std::uint64_t* seen = nullptr) const {
    find_steps(node, scratch_);
    if (seen != nullptr) *seen = scratch_.seen;
    edges_.clear();
    const auto is_any = [](const typename Steps::One&) { return true; };
    for_each_wanted_edge(node, scratch_, is_any,
                         [this](const Edge& edge) { edges_.push_back(edge); });
    return edges_;
  }

  // Calls `visit(node)` for nodes of that part to which a root goes in that state of the system.
  template <typename Visit>
  void for_each_entry(const State& state, std::uint32_t part, Visit&& visit) const {
    constexpr std::uint32_t no_edge = ~std::uint32_t{0};
    for (std::uint32_t root = 0; root < monitor_.states(); ++root) {
      if (!monitor_.is_root(root)) continue;
      // Where a root goes depends on that state alone.
      monitor_.step(state, 0, no_edge, Bits{}, root, [&](std::uint32_t at, const Bits&) {
        if (monitor_.part_of(at) != part) return;
        State node = state;
        system_.monitor().set(node, at);
        visit(node);
      });
    }
  }

  std::vector<State> first_nodes() const {
    std::vector<State> nodes;
    const State initial = steps_.initial();
    // Of a run that begins at an error there is one position, and nothing is known of what follows.
    const bool is_error = system_.is_error(initial);
    monitor_.start(initial, [&](std::uint32_t state, const Bits&) {
      if (is_error && state != monitor_.universal()) return;
      State node = initial;
      system_.monitor().set(node, state);
      nodes.push_back(node);
    });
    return nodes;
  }

  std::uint64_t bytes() const { return table_.peak_bytes() + nodes_.capacity() * sizeof(State); }
  // What it may take to add `count` nodes, and to list them in the end.
  std::uint64_t growth_bytes(std::size_t count) const {
    const std::uint64_t list = !lists_nodes_                               ? size()
                               : nodes_.size() + count > nodes_.capacity() ? 2 * nodes_.capacity()
                                                                           : 0;
    return table_.growth_bytes() + list * sizeof(State);
  }

 private:
  // `is_plain`: the system has plain steps only.
  template <bool is_plain>
  void find_steps_as(const State& node, Steps& found) const {
    found.steps.clear();
    found.enabled = {};
    found.is_over = true;
    found.groups = {};
    found.seen = 0;
    const State state = plain(node);
    for (std::size_t program = 0; program < steps_.actors(); ++program) {
      const Bits bit = bit_of<Bits>(program);
      steps_.template for_each_of<is_plain>(
          state, program,
          [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
            ++found.seen;
            if (is_plain || system_.is_progress(program, edge)) {
              found.is_over = false;
              if (is_plain || system_.is_own(program, edge)) found.enabled |= bit;
            }
            if constexpr (!is_plain) {
              found.groups |= system_.template group_of<Bits>(program, edge);
              if (system_.is_error(next)) return;
            }
            if (is_cut) return;
            found.steps.push_back({next, edge, static_cast<std::uint32_t>(code),
                                   static_cast<std::uint16_t>(program)});
          });
    }
  }

  const PackedSystem& system_;
  PackedSteps<words> steps_;
  const Monitor& monitor_;
  Bits asks_{};
  StateTable<words> table_;
  std::vector<State> nodes_;  // by number, in the order of discovery; once they are listed
  bool lists_nodes_ = false;
  mutable Steps scratch_;
  mutable std::vector<Edge> edges_;
};

// Calls `work` as with_words() does. Searches with wide sets are compiled for the largest states
// alone, and those without for all others.
template <typename Monitor>
inline constexpr bool uses_wide_bits = std::is_same_v<typename Monitor::Bits, WideBits>;
template <typename Monitor, typename Work>
auto with_words_for(const PackedSystem& system, Work&& work) {
  if constexpr (uses_wide_bits<Monitor>) {
    return work(std::integral_constant<std::size_t, PackedSystem::most_words>());
  } else {
    MAIDE_CHECK(system.words() <= most_own_words);
    return with_own_words(system.words(), work);
  }
}

}  // namespace maide
