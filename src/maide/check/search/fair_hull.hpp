// Search by several ranks for a run that a monitor watches and accepts. Depth-first search
// (fair_cycle.hpp) goes one way at a time; this one takes away, from all nodes that can be reached,
// what no fair cycle leads to, until nothing more goes. What is left is empty, or has a fair cycle.
//
//   reach   All nodes are found, breadth-first. The edges that come to each are counted.
//   trim    A node to which no edge comes goes. Then those go to which it led alone.
//   gather  Each node learns which marks lie on edges by which it can be reached, and who steps on
//           them. A node that lacks a mark goes. So does one in which a program can step that has
//           to be treated fairly, if no step of it leads there.
//   cut     An edge goes that asks a pair, if nothing that leads to it answers the pair.
//
// Trimming, gathering and cutting take turns. In the end, a component to which no other leads has
// every mark, and answers every pair that it asks, for the marks that its nodes gathered are its
// own. One of its nodes is found by labels: a
// node's label is the greatest number of the nodes that lead to it, and the least label of all is
// the number of a node in such a component. From there rank 0 makes the run that is shown.
//
// A rank owns the nodes whose states of the system it owns. Each node of a part takes some 40 bytes
// (64 programs, states of 64 bits; without strong fairness). It is expanded once to be reached, and
// then once or more for each turn. Parts of the product (fair_cycle.hpp) are searched one after
// another, each with memory of its own.
//
// Sources: "one way catch them young": Fisler, Fraer, Kamhi, Vardi & Yang, "Is there a best
// symbolic cycle-detection algorithm?", TACAS 2001; on many machines: Cerna & Pelanek, "Distributed
// explicit fair cycle detection", SPIN 2003. Strong fairness: Kesten, Pnueli & Raviv, "Algorithmic
// verification of linear temporal logic specifications", ICALP 1998. Labels: Brim, Cerna, Moravec &
// Simsa, "Accepting predecessors are better than back edges", FMCAD 2004.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <new>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/reduce/step_order.hpp"
#include "maide/check/search/breadth_first_search.hpp"
#include "maide/check/search/fair_cycle.hpp"
#include "maide/check/search/product_graph.hpp"
#include "maide/check/search/ranks.hpp"
#include "maide/check/search/search.hpp"

namespace maide {

// The search of one part of a product.
template <std::size_t words, typename Monitor>
class FairHull {
 public:
  using Reached = typename ProductPart<words>::Reached;

  // `reached`: the system's states, if the monitor has roots; else null. Keeps references. All
  // ranks make the same and call the same.
  FairHull(const PackedSystem& system, const Monitor& monitor, const SearchLimits& limits,
           const Reached* reached, std::uint32_t part)
      : graph_(system, monitor),
        limits_(limits),
        reached_(reached),
        part_(part),
        ranks_(*limits.ranks),
        numbers_(ranks_),
        gains_(ranks_) {
    graph_.list_nodes();
  }

  // The result is the same on all ranks, but that rank 0 alone knows the run to the node.
  SearchResult run() {
    reach();
    if (is_going_on()) shrink();
    if (is_going_on() && has_any_left_) {
      result_.has_violation = true;
      found_ = node_on_fair_cycle();
      if (is_going_on()) end_ = End::found;
    }
    const RankReport sum = together(report());
    result_.states = sum.states;
    result_.transitions = sum.transitions;
    result_.sent_bytes = sum.sent_bytes;
    result_.bytes = std::max(most_bytes_, sum.bytes);
    result_.end = end_;
    if (end_ == End::found) show();
    return std::move(result_);
  }

 private:
  using Graph = ProductGraph<words, Monitor>;
  using State = typename Graph::State;
  using Edge = typename Graph::Edge;
  using Number = typename Graph::Number;
  using Bits = typename Graph::Bits;
  using Share = typename Graph::Share;
  using End = SearchResult::End;

  // What a rank sends to the owner of a node.
  struct NumberFor {
    State node;
    std::uint64_t value = 0;
  };
  // What lies on edges by which that node can be reached.
  struct GainFor {
    State node;
    Bits marks{};
    Share stepped;  // of those that are wanted
  };

  // By what the search came to a node: the code of the step, the monitor's state before, and this.
  static constexpr std::uint64_t is_begin = std::uint64_t{1} << 63, is_stay = is_begin >> 1,
                                 is_counted = is_begin >> 2;
  static constexpr unsigned code_places = 32;

  bool is_going_on() const { return end_ == End::complete; }
  bool is_waiting(const State& node) const {
    return graph_.monitor().is_waiting(graph_.monitor_state(node));
  }
  unsigned owner_of(const State& node) const {
    return maide::owner_of(graph_.address_of(graph_.plain(node)).scrambled, ranks_.size());
  }

  std::uint64_t bytes() const {
    return (reached_ == nullptr ? 0 : reached_->bytes()) + graph_.bytes() +
           came_by_.capacity() * sizeof(std::uint64_t) +
           in_degree_.capacity() * sizeof(std::uint32_t) +
           (marks_.capacity() + barred_.capacity()) * sizeof(Bits) +
           stepped_.capacity() * sizeof(Share) + labels_.capacity() * sizeof(std::uint64_t) +
           queue_.size() * sizeof(Number) + (is_left_.capacity() + is_queued_.capacity()) / 8;
  }
  RankReport report() const {
    RankReport own;
    own.states = graph_.size();
    own.transitions = result_.transitions;
    own.bytes = bytes();
    own.sent_bytes = numbers_.sent_bytes() + gains_.sent_bytes();
    own.stop = static_cast<std::uint8_t>(stop_);
    return own;
  }
  RankReport together(const RankReport& own) {
    const RankReport sum = sum_of(numbers_.exchange(own));
    most_bytes_ = std::max(most_bytes_, sum.bytes);
    return sum;
  }

  // ---- phases ----

  // Hands an item to the owner of its node.
  template <typename Item>
  using Send = std::function<void(const Item& item)>;

  // Rounds until no rank has anything left: `visit_next(send)` works on one node, and is false if
  // there is none; what it sends is given to `arrive` by the owner.
  template <typename Item>
  void run_phase(
      RankBatches<Item>& batches,
      const std::type_identity_t<std::function<bool(const Send<Item>& send)>>& visit_next,
      const std::type_identity_t<Send<Item>>& arrive) {
    const std::size_t round = 16 * limits_.states_a_thread;
    while (is_going_on()) {
      std::vector<std::vector<std::vector<Item>>> away(1);
      away[0].resize(ranks_.size());
      bool is_left = false;
      const Send<Item> send = [&](const Item& item) {
        const unsigned owner = owner_of(item.node);
        if (owner == ranks_.rank()) return arrive(item);
        away[0][owner].push_back(item);
        is_left = true;
      };
      const bool may_work = may_go_on_here();
      guard([&] {
        bool has_more = may_work;
        for (std::size_t i = 0; i < round && has_more; ++i) has_more = visit_next(send);
        is_left = is_left || has_more;
      });
      RankReport own = report();
      own.is_left = is_left;
      own.is_found = found_.has_value();
      batches.send(own, away);
      const auto received = batches.receive();
      const RankReport sum = sum_of(received);
      all_states_ = sum.states;
      most_bytes_ = std::max(most_bytes_, sum.bytes);
      if (sum.is_found) {
        end_ = End::found;
        while (!received[finder_].report.is_found) ++finder_;
      } else {
        end_ = static_cast<End>(sum.stop);
      }
      if (!is_going_on() || !sum.is_left) return;
      guard([&] {
        for (unsigned rank = 0; rank < received.size(); ++rank) {
          for (const Item& item : received[rank].items) arrive(item);
        }
      });
    }
  }
  // Without memory for it this rank has to end, and tells so in the next round.
  template <typename Work>
  void guard(Work&& work) {
    try {
      work();
    } catch (const std::bad_alloc&) {
      stop_ = End::out_of_memory;
    }
  }
  bool may_go_on_here() {
    const std::uint64_t growth = graph_.growth_bytes(16 * limits_.states_a_thread);
    if (!may_go_on(limits_, std::max<std::uint64_t>(all_states_, graph_.size()), bytes(), growth,
                   result_)) {
      stop_ = result_.end;
    }
    return stop_ == End::complete;
  }
  bool pop(Number& number) {
    if (queue_.empty()) return false;
    number = queue_.front();
    queue_.pop_front();
    is_queued_[number] = false;
    return true;
  }
  // A cycle may lie in what is left, and the edges between its nodes alone count, without those
  // that were cut.
  template <typename Visit>
  void for_each_counted_edge(Number number, Visit&& visit) const {
    graph_.for_each_edge(number, [&](const Edge& edge) {
      if (is_waiting(edge.target)) return;
      if (!graph_.has_pairs() || !is_cut(edge, barred_[number])) visit(edge);
    });
  }
  bool is_cut(const Edge& edge, const Bits& barred) const {
    return !is_none(graph_.unanswered(edge.marks) & barred);
  }
  Number number_of(const State& node) const {
    const Number number = graph_.find(node);
    MAIDE_CHECK(number != Graph::no_node);
    return number;
  }

  // ---- reach ----

  void reach() {
    guard([&] {
      for (const State& node : graph_.first_nodes()) {
        if (owner_of(node) != ranks_.rank()) continue;
        if (graph_.monitor().part_of(graph_.monitor_state(node)) == part_) enter({node, is_begin});
      }
      if (reached_ == nullptr) return;
      reached_->table().for_each([&](const State& state, std::uint64_t) {
        if (graph_.system().is_error(state)) return;
        MAIDE_CHECK(owner_of(state) == ranks_.rank());
        graph_.for_each_entry(state, part_, [&](const State& node) { enter({node, is_begin}); });
      });
    });
    Number next = 0;
    run_phase(
        numbers_,
        [&](const auto& send) {
          if (next == graph_.size()) return false;
          expand(next++, send);
          return true;
        },
        [&](const NumberFor& item) { enter(item); });
  }

  void expand(Number number, const Send<NumberFor>& send) {
    const State node = graph_.node(number);  // the list may grow
    const bool waits = is_waiting(node);
    std::uint64_t edges = 0;
    std::uint64_t seen = 0;
    for (const Edge& edge : graph_.edges_of(node, &seen)) {
      ++edges;
      std::uint64_t value = edge.code | std::uint64_t{graph_.monitor_state(node)} << code_places;
      if (!edge.is_step) value |= is_stay;
      if (!waits && !is_waiting(edge.target)) value |= is_counted;
      send(NumberFor{edge.target, value});
    }
    result_.transitions += waits ? seen : edges;
  }

  void enter(const NumberFor& item) {
    const auto [number, is_new] = graph_.insert(item.node);
    if (is_new) {
      came_by_.push_back(item.value & ~is_counted);
      in_degree_.push_back(0);
      is_left_.push_back(!is_waiting(item.node));
      is_queued_.push_back(false);
      if (!found_ && graph_.monitor_state(item.node) == graph_.monitor().universal()) {
        found_ = item.node;
      }
    }
    if ((item.value & is_counted) != 0) ++in_degree_[number];
  }

  // ---- trim and gather ----

  void shrink() {
    guard([&] {
      if (graph_.has_pairs()) barred_.assign(graph_.size(), {});
      for (Number number = 0; number < graph_.size(); ++number) {
        if (is_left_[number] && in_degree_[number] == 0) take_away(number);
      }
    });
    while (true) {
      trim();
      if (!is_going_on()) return;
      RankReport own = report();
      own.next = static_cast<std::uint64_t>(std::ranges::count(is_left_, true));
      has_any_left_ = together(own).next > 0;
      if (!has_any_left_) return;
      gather();
      if (!is_going_on()) return;
      std::uint64_t taken_away = 0;
      guard([&] {
        for (Number number = 0; number < graph_.size(); ++number) {
          if (!is_left_[number] || has_all(number)) continue;
          take_away(number);
          ++taken_away;
        }
      });
      if (graph_.has_pairs()) taken_away += cut();
      if (!is_going_on()) return;
      own = report();
      own.next = taken_away;
      if (together(own).next == 0) return;
    }
  }

  // How many edges go. Those of a node that goes itself are told when it is trimmed.
  std::uint64_t cut() {
    std::uint64_t gone = 0;
    Number next = 0;
    run_phase(
        numbers_,
        [&](const auto& send) {
          if (next == graph_.size()) return false;
          const Number number = next++;
          if (!is_left_[number]) return true;
          const Bits barred = graph_.unanswered(graph_.all_asks() | marks_[number]);
          if (barred == barred_[number]) return true;
          for_each_counted_edge(number, [&](const Edge& edge) {
            if (!is_cut(edge, barred)) return;
            ++gone;
            send(NumberFor{edge.target, 0});
          });
          barred_[number] = barred;
          return true;
        },
        [&](const NumberFor& item) { lose_edge_to(item); });
    return gone;
  }

  // An edge to that node goes.
  void lose_edge_to(const NumberFor& item) {
    const Number number = number_of(item.node);
    if (!is_left_[number]) return;
    MAIDE_CHECK(in_degree_[number] > 0);
    if (--in_degree_[number] == 0) take_away(number);
  }

  void take_away(Number number) {
    is_left_[number] = false;
    queue_.push_back(number);
  }

  void trim() {
    run_phase(
        numbers_,
        [&](const auto& send) {
          Number number = 0;
          if (!pop(number)) return false;
          for_each_counted_edge(number, [&](const Edge& edge) { send(NumberFor{edge.target, 0}); });
          return true;
        },
        [&](const NumberFor& item) { lose_edge_to(item); });
  }

  // All that is left works at least once, and then what learned something new.
  void gather() {
    guard([&] {
      marks_.assign(graph_.size(), {});
      if (graph_.wants_more()) stepped_.assign(graph_.size(), {});
      queue_all_left();
    });
    run_phase(
        gains_,
        [&](const auto& send) {
          Number number = 0;
          if (!pop(number)) return false;
          const Bits marks = marks_[number];
          const Share stepped = graph_.wants_more() ? stepped_[number] : Share();
          for_each_counted_edge(number, [&](const Edge& edge) {
            const GainFor gain{edge.target, marks | graph_.without_asked(edge.marks),
                               stepped | (graph_.share_of(edge) & graph_.wanted())};
            if (!is_none(gain.marks) || !gain.stepped.is_empty()) send(gain);
          });
          return true;
        },
        [&](const GainFor& item) {
          const Number number = number_of(item.node);
          if (is_left_[number] && learn(number, item)) queue_again(number);
        });
  }
  // True if there was something new.
  bool learn(Number number, const GainFor& gain) {
    bool is_new = !is_none(gain.marks & ~marks_[number]);
    marks_[number] |= gain.marks;
    if (!graph_.wants_more()) return is_new;
    Share& stepped = stepped_[number];
    is_new = is_new || !gain.stepped.without(stepped).is_empty();
    stepped = stepped | gain.stepped;
    return is_new;
  }
  void queue_all_left() {
    is_queued_ = is_left_;
    for (Number number = 0; number < graph_.size(); ++number) {
      if (is_left_[number]) queue_.push_back(number);
    }
  }
  void queue_again(Number number) {
    if (is_queued_[number]) return;
    is_queued_[number] = true;
    queue_.push_back(number);
  }
  bool has_all(Number number) const {
    if (!graph_.has_all(marks_[number])) return false;
    return !graph_.wants_more() || graph_.able(number).without(stepped_[number]).is_empty();
  }

  // ---- what was found ----

  // A number of its own for each node of all ranks, not 0. They lie in no order, or labels would be
  // passed on again and again.
  std::uint64_t own_label(Number number) const {
    std::uint32_t turned = 0;
    for (unsigned bit = 0; bit < 32; ++bit) turned |= (number >> bit & 1) << (31 - bit);
    return std::uint64_t{turned} << 32 | (ranks_.rank() + 1);
  }

  std::optional<State> node_on_fair_cycle() {
    guard([&] {
      marks_ = {};
      stepped_ = {};
      labels_.assign(graph_.size(), 0);
      queue_all_left();
    });
    run_phase(
        numbers_,
        [&](const auto& send) {
          Number number = 0;
          if (!pop(number)) return false;
          const std::uint64_t label = std::max(labels_[number], own_label(number));
          for_each_counted_edge(number, [&](const Edge& edge) {
            send(NumberFor{edge.target, label});
          });
          return true;
        },
        [&](const NumberFor& item) {
          const Number number = number_of(item.node);
          if (!is_left_[number] || labels_[number] >= item.value) return;
          labels_[number] = item.value;
          queue_again(number);
        });
    if (!is_going_on()) return std::nullopt;
    RankReport own;
    own.next = ~std::uint64_t{0};
    for (Number number = 0; number < graph_.size(); ++number) {
      if (is_left_[number]) own.next = std::min(own.next, labels_[number]);
    }
    std::uint64_t least = own.next;
    for (const auto& batch : numbers_.exchange(own)) least = std::min(least, batch.report.next);
    finder_ = static_cast<unsigned>(least & 0xffffffff) - 1;
    if (finder_ != ranks_.rank()) return std::nullopt;
    for (Number number = 0; number < graph_.size(); ++number) {
      if (own_label(number) == least) return graph_.node(number);
    }
    throw std::logic_error("the search lost a node on a cycle");
  }

  template <typename Value>
  Value from(unsigned rank, const Value* own) {
    Ranks::Bytes bytes(sizeof(Value));
    if (ranks_.rank() == rank) std::memcpy(bytes.data(), own, sizeof(Value));
    ranks_.broadcast(bytes, rank);
    MAIDE_CHECK_ALWAYS(bytes.size() == sizeof(Value));
    Value value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  // The run to the node that was found, from which each rank sees its own part.
  void show() {
    const PackedSystem& system = graph_.system();
    State node = from(finder_, found_ ? &*found_ : nullptr);
    result_.has_violation = true;
    result_.near.emplace(system.unpack(graph_.plain(node)), graph_.monitor_state(node));
    Trace last;
    for (std::uint64_t steps = 0;; ++steps) {
      MAIDE_CHECK(steps <= result_.states);
      const unsigned owner = owner_of(node);
      const std::uint64_t came_by =
          from(owner, owner == ranks_.rank() ? &came_by_[number_of(node)] : nullptr);
      if ((came_by & is_begin) != 0) break;
      State before = node;
      if ((came_by & is_stay) == 0) {
        StepBefore origin =
            graph_.steps().undo(graph_.plain(node), came_by & low_bits(code_places));
        last.steps.push_back(origin.step);
        before = system.pack<words>(origin.before);
      }
      system.monitor().set(before, static_cast<std::uint32_t>((came_by & ~is_stay) >> code_places));
      node = before;
    }
    result_.trace.emplace();
    if (reached_ != nullptr) result_.trace = reached_->run_to(graph_.plain(node));
    result_.trace->steps.insert(result_.trace->steps.end(), last.steps.rbegin(), last.steps.rend());
  }

  Graph graph_;
  const SearchLimits& limits_;
  const Reached* reached_;
  std::uint32_t part_;
  Ranks& ranks_;
  RankBatches<NumberFor> numbers_;
  RankBatches<GainFor> gains_;
  // By node.
  std::vector<std::uint64_t> came_by_;
  std::vector<std::uint32_t> in_degree_;  // edges from what is left, if it is left
  std::vector<bool> is_left_;             // a fair cycle may lead to it
  std::vector<bool> is_queued_;
  std::vector<Bits> marks_;     // gathered
  std::vector<Bits> barred_;    // if there are pairs: those that nothing answers
  std::vector<Share> stepped_;  // gathered, if the monitor wants more than marks
  std::vector<std::uint64_t> labels_;
  std::deque<Number> queue_;
  std::optional<State> found_;  // this rank's
  unsigned finder_ = 0;         // the rank whose node is shown
  bool has_any_left_ = true;    // some rank
  std::uint64_t all_states_ = 0, most_bytes_ = 0;
  End stop_ = End::complete;  // why this rank has to end
  End end_ = End::complete;   // why all do
  SearchResult result_;
};

// Searches a product by all ranks, with all steps taken, part by part. Of a violation the result
// has a node near it and the run there.
template <std::size_t words, typename Monitor>
SearchResult search_hull(const PackedSystem& system, const Monitor& monitor,
                         const SearchLimits& limits) {
  using Reached = typename ProductPart<words>::Reached;
  std::uint64_t roots = 0;
  for (std::uint32_t at = 0; at < monitor.states(); ++at) roots += monitor.is_root(at) ? 1 : 0;
  const StepOrder order(system);
  BreadthFirstOptions options(limits);
  options.order = &order;
  std::optional<Reached> reached;
  SearchResult result;
  if (roots > 0) {
    result = reached.emplace(system, limits, options).run();
    if (result.end != SearchResult::End::complete) return result;
    count_roots(system, *reached, roots, result, limits.ranks);
  }
  for (std::uint32_t part = 0; part < monitor.parts(); ++part) {
    SearchResult one =
        FairHull<words, Monitor>(system, monitor, limits, reached ? &*reached : nullptr, part)
            .run();
    result.states += one.states;
    result.transitions += one.transitions;
    result.bytes = std::max(result.bytes, one.bytes);
    result.sent_bytes += one.sent_bytes;
    if (one.end == SearchResult::End::complete) continue;
    result.end = one.end;
    result.has_violation = one.has_violation;
    result.trace = std::move(one.trace);
    result.near = std::move(one.near);
    break;
  }
  return result;
}

}  // namespace maide
