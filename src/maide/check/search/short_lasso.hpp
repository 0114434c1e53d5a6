// Looks for a shorter run than the one that a search for a fair cycle found. That search goes
// depth-first, so it meets a cycle far from the start, and knows few of the ways round it. Here the
// product's nodes are visited breadth-first, as far as a shorter run may reach, and at most
// `most_nodes` of them. In each accepted part of what was seen, runs are compared that enter the
// part at a node, nearest nodes first, and go round past everything that a fair cycle needs.
//
// Round is a shortest way if there are few needs: a breadth-first search over a node and the needs
// that were met. Else it is the nearest need, then the nearest of those left, then home. A pair has
// two bits among the needs: it is answered, and it is asked, and the first is needed if the second
// was met. Invariant: what is returned is shorter than any run found before, and `is_good`.
// O(nodes x edges), but at most `most_work` edges are looked at for ways round.
//
// Example: 9 steps to a cycle of 2 are found first; a node 3 steps from the start lies on a cycle
// of 5, and the run of 8 steps is taken. One of 3 steps to a cycle of 8 is not: it is as long.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"
#include "maide/check/search/fair_lasso.hpp"
#include "maide/check/search/product_graph.hpp"

namespace maide {

// For monitors whose bits are one word.
template <std::size_t words, typename Monitor>
class ShortLasso {
 public:
  // Keeps references. `system` was made with node_number_bits of payload and the monitor's states.
  ShortLasso(const PackedSystem& system, const Monitor& monitor, const RunControl& control)
      : graph_(system, monitor), control_(control) {}

  // A run of less than `length` steps for which `is_good`; nothing if none was found. `first`:
  // where runs begin; none: at the graph's first nodes. Throws Interrupted when the control says to
  // stop, and std::bad_alloc.
  std::optional<Trace> find(std::size_t length, const std::function<bool(const Trace&)>& is_good,
                            std::vector<PackedState<words>> first = {}) {
    length_ = length;
    is_good_ = is_good;
    visit(first.empty() ? graph_.first_nodes() : first);
    for (Part& part : find_parts()) search(part);
    return std::move(best_);
  }

 private:
  using Graph = ProductGraph<words, Monitor>;
  using Number = typename Graph::Number;
  using Edge = typename Graph::Edge;

  static constexpr std::size_t most_nodes = std::size_t{1} << 15;
  static constexpr std::uint64_t most_work = std::uint64_t{1} << 22;
  static constexpr std::size_t most_places = std::size_t{1} << 18;  // of a node and met needs
  static constexpr std::size_t most_sparse_places = std::size_t{1} << 16;

  // An edge between nodes that were seen.
  struct Link {
    Number target = 0;
    std::uint32_t code = 0;  // of the step
    std::uint64_t marks = 0;
    std::uint64_t needs = 0;  // that it meets, by bit, in the part that is searched
    typename Graph::Share share;
    bool is_step = false;
  };
  struct Node {
    std::size_t first = 0, last = 0;  // of its links
    Number parent = Graph::no_node;   // on a shortest way
    std::uint32_t link = 0;           // from there
    std::uint32_t depth = 0;
  };
  struct HashOfPlace {
    std::size_t operator()(const std::pair<Number, std::uint64_t>& place) const {
      return hash_mix(place.first, place.second);
    }
  };
  // A part of the graph in which a fair cycle lies.
  struct Part {
    FairPart<Graph> graph;
    std::uint64_t all = 0;   // needs, by bit
    std::uint64_t asks = 0;  // bits, each behind the one that is needed if it was met
    unsigned count = 0;      // of bits

    std::uint64_t unanswered(std::uint64_t met) const { return met & asks & ~(met << 1); }
    // The needs that are left.
    std::uint64_t missing(std::uint64_t met) const { return (all & ~met) | unanswered(met) >> 1; }
    // What was met, in one way if it makes no difference: a pair that is answered may be asked.
    std::uint64_t in_one_way(std::uint64_t met) const { return met | (met << 1 & asks); }
  };

  // ---- what lies near ----

  void visit(const std::vector<PackedState<words>>& first) {
    for (const auto& node : first) add(node, Graph::no_node, 0, 0);
    graph_.list_nodes();
    for (Number number = 0; number < nodes_.size(); ++number) {
      look(1);
      nodes_[number].first = nodes_[number].last = links_.size();
      if (nodes_[number].depth >= length_) continue;
      const std::uint32_t depth = nodes_[number].depth + 1;
      for (const Edge& edge : graph_.edges_of(graph_.node(number))) {
        const auto target =
            add(edge.target, number, static_cast<std::uint32_t>(links_.size()), depth);
        if (target == Graph::no_node) continue;
        links_.push_back({target, edge.code, edge.marks, 0, graph_.share_of(edge), edge.is_step});
      }
      nodes_[number].last = links_.size();
    }
  }

  Number add(const typename Graph::State& node, Number parent, std::uint32_t link,
             std::uint32_t depth) {
    const Number known = graph_.find(node);
    if (known != Graph::no_node || nodes_.size() >= most_nodes) return known;
    const Number number = graph_.insert(node).number;
    MAIDE_CHECK(number == nodes_.size());
    nodes_.push_back({0, 0, parent, link, depth});
    return number;
  }

  // ---- parts ----

  std::vector<Part> find_parts() {
    std::vector<Number> all(nodes_.size());
    for (Number number = 0; number < all.size(); ++number) {
      all[number] = number;
      if (graph_.monitor_state(graph_.node(number)) != graph_.monitor().universal()) continue;
      consider(number, {});  // whatever comes is accepted
      nodes_[number].last = nodes_[number].first;
    }
    FairParts<Graph> fair(graph_, control_);
    std::vector<Part> parts;
    for (auto& component : fair.components_of({std::move(all), {}})) {
      auto accepted = fair.find(std::move(component));
      if (!accepted) continue;
      Part part;
      part.graph = std::move(*accepted);
      if (number_needs(part)) parts.push_back(std::move(part));
    }
    return parts;
  }

  // Gives each mark, program and fair group that the cycle needs a bit, and each pair that it may
  // ask two; false if there are too many.
  bool number_needs(Part& part) {
    const std::uint64_t marks = graph_.all_marks();
    typename Graph::Share wanted;
    if (graph_.wants_more()) {
      for (const Number member : part.graph.members) wanted = wanted | graph_.able(member);
    }
    std::uint64_t asked = 0;
    if (graph_.has_pairs()) {
      for (const Number member : part.graph.members) {
        for_each_edge_within(graph_, part.graph, member,
                             [&](const Edge& edge, Number) { asked |= graph_.asked(edge.marks); });
      }
    }
    const std::uint64_t pairs = asked | asked >> 1;
    const int required =
        std::popcount(marks) + std::popcount(wanted.programs) + std::popcount(wanted.groups);
    const int count = required + std::popcount(pairs);
    if (count > 64) return false;
    part.count = static_cast<unsigned>(count);
    part.all = low_bits(static_cast<unsigned>(required));
    for (auto bit = static_cast<unsigned>(required) + 1; bit < part.count; bit += 2) {
      part.asks |= std::uint64_t{1} << bit;
    }
    for (const Number member : part.graph.members) {
      for (std::size_t at = nodes_[member].first; at < nodes_[member].last; ++at) {
        Link& link = links_[at];
        std::uint64_t needs = 0;
        unsigned bit = 0;
        const auto append = [&](std::uint64_t wanted_bits, std::uint64_t bits) {
          for (std::uint64_t left = wanted_bits; left != 0; left &= left - 1, ++bit) {
            if ((bits & left & (~left + 1)) != 0) needs |= std::uint64_t{1} << bit;
          }
        };
        append(marks, link.marks);
        append(wanted.programs, link.share.programs);
        append(wanted.groups, link.share.groups);
        append(pairs, link.marks);
        link.needs = needs;
      }
    }
    return true;
  }

  // ---- ways round ----

  void search(const Part& part) {
    places_.assign(nodes_.size(), Graph::no_node);
    const auto& members = part.graph.members;
    for (std::size_t i = 0; i < members.size(); ++i) {
      places_[members[i]] = static_cast<Number>(i);
    }
    const bool is_small = part.count < 18 && (members.size() << part.count) <= most_places;
    const bool is_sparse = !is_small && part.asks != 0;  // few of the places may be met
    // Numbers are in the order of the depth.
    for (const Number start : members) {
      if (nodes_[start].depth + 1 >= length_ || work_ > most_work) return;
      std::vector<std::size_t> loop;
      if (is_small) {
        std::vector<bool> seen(members.size() << part.count);
        loop = shortest_round(part, start, [&](Number member, std::uint64_t met) {
          const std::size_t place = member + members.size() * met;
          if (seen[place]) return false;
          seen[place] = true;
          return true;
        });
      } else if (is_sparse) {
        std::unordered_set<std::pair<Number, std::uint64_t>, HashOfPlace> seen;
        loop = shortest_round(part, start, [&](Number member, std::uint64_t met) {
          return seen.size() < most_sparse_places && seen.emplace(member, met).second;
        });
      }
      if (loop.empty() && !is_small) loop = round_by_nearest(part, start);
      if (!loop.empty()) consider(start, loop);
    }
  }

  bool is_inside(const Part& part, const Link& link) const {
    return places_[link.target] != Graph::no_node && (link.marks & part.graph.barred) == 0;
  }

  // What a run to a node of that depth may still take.
  std::size_t room(Number start) const { return length_ - nodes_[start].depth; }

  // The links of a shortest way round, by a search over (met needs, member), those that are new to
  // `see`; empty if there is none of less than room() links.
  template <typename See>
  std::vector<std::size_t> shortest_round(const Part& part, Number start, See&& see) {
    struct Place {
      std::size_t before = 0;
      std::size_t link = 0;
      Number node = 0;
      std::uint64_t met = 0;
      std::uint32_t depth = 0;
    };
    std::vector<Place> queue{{0, 0, start, 0, 0}};
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const Place place = queue[at];
      if (place.depth + 1 >= room(start)) break;
      for (std::size_t link = nodes_[place.node].first; link < nodes_[place.node].last; ++link) {
        look(1);
        if (!is_inside(part, links_[link])) continue;
        const std::uint64_t met = part.in_one_way(place.met | links_[link].needs);
        if (!see(places_[links_[link].target], met)) continue;
        queue.push_back({at, link, links_[link].target, met, place.depth + 1});
        if (links_[link].target != start || part.missing(met) != 0) continue;
        std::vector<std::size_t> loop;
        for (std::size_t back = queue.size() - 1; back != 0; back = queue[back].before) {
          loop.push_back(queue[back].link);
        }
        std::ranges::reverse(loop);
        return loop;
      }
    }
    return {};
  }

  // Always to the nearest link that meets a need, and home in the end.
  std::vector<std::size_t> round_by_nearest(const Part& part, Number start) {
    std::vector<std::size_t> loop;
    std::uint64_t met = 0;
    for (Number at = start; part.missing(met) != 0 || at != start || loop.empty();) {
      const std::uint64_t missing = part.missing(met);
      const std::size_t length = loop.size();
      append_nearest(part, at, loop, [&](const Link& link) {
        return missing == 0 ? link.target == start : (link.needs & missing) != 0;
      });
      if (loop.size() == length) return {};  // only by nodes too deep for their links to be known
      for (std::size_t i = length; i < loop.size(); ++i) met |= links_[loop[i]].needs;
      at = links_[loop.back()].target;
      if (loop.size() >= room(start)) return {};
    }
    return loop;
  }

  // A shortest way in the part whose last link is wanted.
  template <typename IsWanted>
  void append_nearest(const Part& part, Number from, std::vector<std::size_t>& way,
                      IsWanted&& is_wanted) {
    struct Reached {
      std::size_t before = 0, link = 0;
      Number node = 0;
    };
    std::vector<Reached> queue{{0, 0, from}};
    std::vector<bool> seen(nodes_.size());
    seen[from] = true;
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const Number node = queue[at].node;
      for (std::size_t link = nodes_[node].first; link < nodes_[node].last; ++link) {
        look(1);
        const Number target = links_[link].target;
        if (!is_inside(part, links_[link])) continue;
        const bool is_last = is_wanted(links_[link]);
        if (!is_last && seen[target]) continue;
        seen[target] = true;
        queue.push_back({at, link, target});
        if (!is_last) continue;
        const std::size_t begin = way.size();
        for (std::size_t back = queue.size() - 1; back != 0; back = queue[back].before) {
          way.push_back(queue[back].link);
        }
        std::reverse(way.begin() + static_cast<std::ptrdiff_t>(begin), way.end());
        return;
      }
    }
  }

  void consider(Number start, const std::vector<std::size_t>& loop) {
    std::vector<std::size_t> way;
    for (Number at = start; nodes_[at].parent != Graph::no_node; at = nodes_[at].parent) {
      way.push_back(nodes_[at].link);
    }
    std::ranges::reverse(way);
    Trace trace;
    append(way, trace);
    const std::size_t loop_start = trace.steps.size();
    append(loop, trace);
    if (trace.steps.size() > loop_start) trace.loop_start = loop_start;
    if (trace.steps.size() >= length_ || !is_good_(trace)) return;
    length_ = trace.steps.size();
    best_ = std::move(trace);
  }

  void append(const std::vector<std::size_t>& way, Trace& trace) const {
    for (const std::size_t at : way) {
      const Link& link = links_[at];
      if (!link.is_step) continue;
      trace.steps.push_back(graph_.steps().undo(graph_.node(link.target), link.code).step);
    }
  }

  void look(std::uint64_t work) {
    const std::uint64_t before = work_ / limit_interval;
    work_ += work;
    if (work_ / limit_interval != before) control_.check("the search for a shorter run");
  }

  Graph graph_;
  const RunControl& control_;
  std::size_t length_ = 0;  // a run is to be shorter
  std::function<bool(const Trace&)> is_good_;
  std::optional<Trace> best_;
  std::vector<Node> nodes_;     // by number
  std::vector<Link> links_;     // grouped by node
  std::vector<Number> places_;  // of a part's members by number; no_node of others
  std::uint64_t work_ = 0;
};

}  // namespace maide
