#include "maide/learn/passive/rpni.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"

namespace maide {
namespace {

class Merger {
 public:
  Merger(const TraceLog& log, const RunControl& control) : log_(log), control_(control) {
    add_node();
    for (std::size_t trace = 0; trace < log.traces.size(); ++trace) {
      if (trace % 256 == 0) control.check("reading the log");
      insert(trace);
    }
    is_red_.resize(first_.size());
    promote(0);
  }

  PassiveModel run() {
    while (!blue_.empty()) {
      merge_or_promote();
      Progress progress;
      progress.phase = "merging states";
      progress.states = red_.size();
      control_.report(progress);
    }
    return make_model();
  }

 private:
  using Node = std::uint32_t;
  using EdgeId = std::uint32_t;
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct Edge {
    Symbol input, output;
    Node target;
    EdgeId next;  // the next one of the same node
  };
  struct Blue {
    EdgeId parent;       // the edge of a red state that leads there
    std::size_t weight;  // edges of its tree
  };

  Node add_node() {
    first_.push_back(none);
    return static_cast<Node>(first_.size() - 1);
  }
  EdgeId add_edge(Node node, Symbol input, Symbol output, Node target) {
    edges_.push_back({input, output, target, first_[node]});
    return first_[node] = static_cast<EdgeId>(edges_.size() - 1);
  }
  EdgeId find(Node node, Symbol input) const {
    EdgeId edge = first_[node];
    while (edge != none && edges_[edge].input != input) edge = edges_[edge].next;
    return edge;
  }

  void insert(std::size_t number) {
    const TraceLog::Trace& trace = log_.traces[number];
    Node node = 0;
    for (std::size_t i = 0; i < trace.inputs.size(); ++i) {
      const EdgeId edge = find(node, trace.inputs[i]);
      if (edge == none) {
        const Node child = add_node();
        add_edge(node, trace.inputs[i], trace.outputs[i], child);
        node = child;
        continue;
      }
      if (edges_[edge].output != trace.outputs[i]) {
        throw UsageError(located(
            fmt::format(
                "trace {} contradicts one before it: \"{}\" ends in '{}' here and in '{}' there",
                number + 1, to_string(std::span(trace.inputs).first(i + 1), log_.inputs),
                log_.outputs.name(trace.outputs[i]), log_.outputs.name(edges_[edge].output)),
            log_));
      }
      node = edges_[edge].target;
    }
  }

  // Edges below a node of a tree. O(these).
  std::size_t count_edges(Node node) const {
    std::size_t count = 0;
    std::vector<Node> stack{node};
    while (!stack.empty()) {
      const Node next = stack.back();
      stack.pop_back();
      for (EdgeId edge = first_[next]; edge != none; edge = edges_[edge].next) {
        ++count;
        stack.push_back(edges_[edge].target);
      }
    }
    return count;
  }

  void promote(Node node) {
    is_red_[node] = true;
    red_.push_back(node);
    blue_.erase(node);
    for (EdgeId edge = first_[node]; edge != none; edge = edges_[edge].next) {
      blue_[edges_[edge].target] = {edge, count_edges(edges_[edge].target)};
    }
  }

  // Makes `blue` and `red` one state and folds the tree below `blue` into what follows `red`.
  // Returns the number of edges that both had, or nothing at the first that contradicts. The tree
  // is walked once: parts of it that the other side lacks are hung there as they are. `grafted` is
  // called with the node that got the new edge, and the blue state in whose tree that lies, if any.
  template <typename Grafted>
  std::optional<std::size_t> fold(Node blue, Node red, Grafted&& grafted) {
    edges_[blue_.at(blue).parent].target = red;
    struct Pair {
      Node from, to;
      Node tree;  // the blue state above `to`; none if `to` is red
    };
    std::size_t evidence = 0;
    std::vector<Pair> stack{{blue, red, none}};
    while (!stack.empty()) {
      const Pair pair = stack.back();
      stack.pop_back();
      for (EdgeId id = first_[pair.from]; id != none; id = edges_[id].next) {
        const Edge edge = edges_[id];
        const EdgeId same = find(pair.to, edge.input);
        if (same == none) {
          grafted(add_edge(pair.to, edge.input, edge.output, edge.target), pair.to, pair.tree);
          continue;
        }
        if (edges_[same].output != edge.output) return std::nullopt;
        ++evidence;
        const Node target = edges_[same].target;
        const Node tree = pair.tree == none ? target : pair.tree;
        stack.push_back({edge.target, target, is_red_[target] ? none : tree});
      }
    }
    return evidence;
  }

  // What folding would give; leaves everything as it was.
  std::optional<std::size_t> evidence(Node blue, Node red) {
    std::vector<Node> changed;
    const auto result = fold(blue, red, [&](EdgeId, Node node, Node) { changed.push_back(node); });
    for (; !changed.empty(); changed.pop_back()) {
      first_[changed.back()] = edges_.back().next;
      edges_.pop_back();
    }
    edges_[blue_.at(blue).parent].target = blue;
    return result;
  }

  void merge(Node blue, Node red) {
    fold(blue, red, [&](EdgeId edge, Node node, Node tree) {
      const Node target = edges_[edge].target;
      const std::size_t below = count_edges(target);
      if (is_red_[node]) {
        blue_[target] = {edge, below};
      } else {
        blue_.at(tree).weight += below + 1;
      }
    });
    blue_.erase(blue);
  }

  // The one with most edges below, the oldest of several.
  Node heaviest_blue() const {
    return std::ranges::max_element(blue_,
                                    [](const auto& left, const auto& right) {
                                      return left.second.weight < right.second.weight;
                                    })
        ->first;
  }

  void merge_or_promote() {
    const Node blue = heaviest_blue();
    std::optional<std::size_t> most;
    Node best = 0;
    for (const Node red : red_) {
      control_.check("merging states");
      const auto found = evidence(blue, red);
      if (!found || (most && *found <= *most)) continue;
      most = found;
      best = red;
    }
    if (most) {
      merge(blue, best);
    } else {
      promote(blue);
    }
  }

  PassiveModel make_model() {
    std::map<Node, StateId> number;
    for (const Node node : red_) number.emplace(node, static_cast<StateId>(number.size()));
    PassiveModel result{Mealy(log_.inputs, log_.outputs, red_.size()), 0};
    for (const auto& [node, state] : number) {
      for (Symbol input = 0; input < log_.inputs.size(); ++input) {
        const EdgeId edge = find(node, input);
        if (edge == none) {
          const Symbol unexplored = result.machine.intern_output("unexplored");
          result.machine.set_transition(state, input, unexplored, state);
          ++result.unseen_transitions;
        } else {
          result.machine.set_transition(state, input, edges_[edge].output,
                                        number.at(edges_[edge].target));
        }
      }
    }
    result.machine = minimize(result.machine);
    return result;
  }

  const TraceLog& log_;
  const RunControl& control_;
  std::vector<EdgeId> first_;  // by node
  std::vector<Edge> edges_;
  std::vector<char> is_red_;  // by node
  std::vector<Node> red_;     // in the order in which they were found
  std::map<Node, Blue> blue_;
};

}  // namespace

PassiveModel learn_passively(const TraceLog& log, const RunControl& control) {
  if (log.inputs.empty()) throw UsageError(located("the log has no inputs to learn from", log));
  return Merger(log, control).run();
}

}  // namespace maide
