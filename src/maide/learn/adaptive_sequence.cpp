#include "maide/learn/adaptive_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace maide {
namespace {

class Planner {
 public:
  explicit Planner(const ObservationTree& tree) : tree_(tree), counts_(tree.input_count()) {}

  // Appends the sequence for these suspects; false if no two of them are apart.
  bool append(const std::vector<Suspect>& suspects, DecisionTree& result) {
    if (suspects.size() < 2) return false;
    const std::optional<Symbol> input = choose_input(suspects);
    if (!input) return false;
    const std::size_t place = result.nodes.size();
    result.nodes.push_back({*input, {}});
    for (const Group& group : group_by_output(suspects, *input)) {
      const auto below = static_cast<std::uint32_t>(result.nodes.size());
      if (!append(group.suspects, result)) continue;
      result.nodes[place].branches.emplace_back(group.output, below);
    }
    return true;
  }

 private:
  // Suspects that gave the same output, as the nodes they came to.
  struct Group {
    Symbol output;
    std::vector<Suspect> suspects;
  };

  // Of the inputs that tell some apart at once the one of least estimated cost, one that is known
  // from all suspects if there is any: the others may need another query. If none tells some apart,
  // the first of a shortest word that does.
  std::optional<Symbol> choose_input(const std::vector<Suspect>& suspects) {
    const std::vector<Symbol> inputs = shared_inputs(suspects);
    for (const bool known_from_all : {true, false}) {
      std::optional<Symbol> best;
      double least = std::numeric_limits<double>::infinity();
      for (const Symbol input : inputs) {
        if ((counts_[input] == suspects.size()) != known_from_all) continue;
        const double cost = estimate(suspects, input);
        if (cost >= least) continue;
        least = cost;
        best = input;
      }
      if (best) return best;
    }
    return first_of_witness(suspects);
  }

  // Inputs known from at least two suspects, ascending.
  std::vector<Symbol> shared_inputs(const std::vector<Suspect>& suspects) {
    std::vector<Symbol> inputs;
    std::fill(counts_.begin(), counts_.end(), 0U);
    for (const Suspect& suspect : suspects) {
      tree_.for_each_child(suspect.node, [&](ObservationTree::Node child) {
        if (++counts_[tree_.input(child)] == 2) inputs.push_back(tree_.input(child));
      });
    }
    std::sort(inputs.begin(), inputs.end());
    return inputs;
  }

  // Weight x symbols until one suspect is left; infinite if the input tells no two apart at once.
  double estimate(const std::vector<Suspect>& suspects, Symbol input) {
    outputs_.clear();
    double weight = 0;
    for (const Suspect& suspect : suspects) {
      weight += suspect.weight;
      const auto child = tree_.child(suspect.node, input);
      if (child == ObservationTree::none) continue;
      const Symbol output = tree_.output(child);
      auto found = std::find_if(outputs_.begin(), outputs_.end(),
                                [&](const Count& count) { return count.output == output; });
      if (found == outputs_.end()) found = outputs_.insert(found, {output, 0, 0});
      ++found->suspects;
      found->weight += suspect.weight;
    }
    if (outputs_.size() < 2) return std::numeric_limits<double>::infinity();
    double cost = weight;
    for (const Count& count : outputs_) {
      if (count.suspects > 1) {
        cost += count.weight * (1 + std::log2(static_cast<double>(count.suspects))) / 2;
      }
    }
    return cost;
  }

  // The first input of a shortest word that tells two suspects apart. All are walked together, so
  // it costs the trees below them and not the square of their number.
  std::optional<Symbol> first_of_witness(const std::vector<Suspect>& suspects) const {
    struct Place {
      Symbol first;
      std::vector<ObservationTree::Node> nodes;  // to which one word leads, with the same outputs
    };
    std::vector<ObservationTree::Node> roots;
    for (const Suspect& suspect : suspects) roots.push_back(suspect.node);
    std::deque<Place> queue{{0, std::move(roots)}};
    std::map<Symbol, std::vector<ObservationTree::Node>> children;
    for (bool is_root = true; !queue.empty(); is_root = false, queue.pop_front()) {
      children.clear();
      for (const ObservationTree::Node node : queue.front().nodes) {
        tree_.for_each_child(node, [&](ObservationTree::Node child) {
          children[tree_.input(child)].push_back(child);
        });
      }
      for (auto& [input, nodes] : children) {
        const Symbol first = is_root ? input : queue.front().first;
        const auto answers_otherwise = [&, output = tree_.output(nodes.front())](auto node) {
          return tree_.output(node) != output;
        };
        if (std::any_of(nodes.begin(), nodes.end(), answers_otherwise)) return first;
        if (nodes.size() > 1) queue.push_back({first, std::move(nodes)});
      }
    }
    return std::nullopt;
  }

  std::vector<Group> group_by_output(const std::vector<Suspect>& suspects, Symbol input) const {
    std::vector<Group> groups;
    for (const Suspect& suspect : suspects) {
      const auto child = tree_.child(suspect.node, input);
      if (child == ObservationTree::none) continue;
      const Symbol output = tree_.output(child);
      auto group = std::find_if(groups.begin(), groups.end(),
                                [&](const Group& other) { return other.output == output; });
      if (group == groups.end()) group = groups.insert(group, {output, {}});
      group->suspects.push_back({child, suspect.weight});
    }
    return groups;
  }

  struct Count {
    Symbol output;
    std::size_t suspects;
    double weight;
  };

  const ObservationTree& tree_;
  std::vector<unsigned> counts_;  // by input
  std::vector<Count> outputs_;
};

}  // namespace

DecisionTree find_adaptive_sequence(const ObservationTree& tree, std::vector<Suspect> suspects) {
  DecisionTree result;
  Planner(tree).append(suspects, result);
  return result;
}

}  // namespace maide
