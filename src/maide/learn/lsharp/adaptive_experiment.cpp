#include "maide/learn/lsharp/adaptive_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <span>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// The nodes whose inputs an outcome answers.
std::vector<std::size_t> nodes_along(const DecisionTree& tree, std::span<const Symbol> outcome) {
  std::vector<std::size_t> nodes;
  std::size_t node = 0;
  for (const Symbol output : outcome) {
    nodes.push_back(node);
    const auto& branches = tree.nodes[node].branches;
    const auto branch =
        std::ranges::find(branches, output, &std::pair<Symbol, std::uint32_t>::first);
    if (branch == branches.end()) break;
    MAIDE_CHECK(branch->second > node && branch->second < tree.nodes.size());
    node = branch->second;
  }
  MAIDE_CHECK(nodes.size() == outcome.size());  // only the last output of an outcome has no branch
  return nodes;
}

}  // namespace

DecisionTree chain(std::span<const Symbol> inputs, std::span<const Symbol> outputs) {
  MAIDE_CHECK(outputs.size() + 1 >= inputs.size());
  DecisionTree tree;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    tree.nodes.push_back({inputs[i], {}});
    if (i + 1 == inputs.size()) break;
    tree.nodes[i].branches.emplace_back(outputs[i], static_cast<std::uint32_t>(i + 1));
  }
  return tree;
}

void graft(DecisionTree& tree, std::size_t node, std::span<const Symbol> outputs,
           const DecisionTree& subtree) {
  MAIDE_CHECK(node < tree.nodes.size() && !subtree.nodes.empty());
  const auto offset = static_cast<std::uint32_t>(tree.nodes.size());
  for (const Symbol output : outputs) tree.nodes[node].branches.emplace_back(output, offset);
  for (DecisionTree::Node copy : subtree.nodes) {
    for (auto& branch : copy.branches) branch.second += offset;
    tree.nodes.push_back(std::move(copy));
  }
}

void graft(DecisionTree& tree, std::size_t node, Symbol output, const DecisionTree& subtree) {
  graft(tree, node, std::span(&output, 1), subtree);
}

void lengthen(DecisionTree& tree, std::span<const Symbol> outcome, const DecisionTree& subtree) {
  if (outcome.empty()) {
    tree = subtree;
  } else {
    const std::size_t last = nodes_along(tree, outcome).back();
    MAIDE_CHECK(std::ranges::count(tree.nodes[last].branches, outcome.back(),
                                   &std::pair<Symbol, std::uint32_t>::first) == 0);
    graft(tree, last, outcome.back(), subtree);
  }
}

Word inputs_along(const DecisionTree& tree, std::span<const Symbol> outcome) {
  Word inputs;
  for (const std::size_t node : nodes_along(tree, outcome)) {
    inputs.push_back(tree.nodes[node].input);
  }
  return inputs;
}

namespace {

class Planner {
 public:
  Planner(const ObservationTree& tree, KnownWitnesses& known)
      : tree_(tree),
        known_(known),
        first_answer_(tree.input_count()),
        children_by_input_(tree.input_count()) {
    if (std::exchange(known_.tree_size, tree.size()) != tree.size()) known_.searches.clear();
  }

  // Parts that are likely to be met come first, until there are `most_inputs`; but those before the
  // first that tells some apart are always there.
  DecisionTree plan(std::vector<WeightedNode> candidates, std::size_t most_inputs) {
    DecisionTree result;
    std::priority_queue<Part> parts;
    const auto add = [&](std::size_t place, Group group, Witness witness) {
      if (group.candidates.size() < 2) return;
      double weight = 0;
      for (const WeightedNode& candidate : group.candidates) weight += candidate.weight;
      MAIDE_CHECK(weight > 0);
      parts.push({weight, parts_made_++, place, std::move(group), std::move(witness)});
    };
    add(0, {0, std::move(candidates)}, {});
    bool has_split = false;
    while (!parts.empty() && (!has_split || result.nodes.size() < most_inputs)) {
      Part part = parts.top();
      parts.pop();
      must_split_ = !has_split;
      const std::optional<Symbol> input = choose_input(part.group.candidates, part.witness);
      if (!input) continue;
      const std::size_t place = result.nodes.size();
      result.nodes.push_back({*input, {}});
      if (place > 0) {
        result.nodes[part.place].branches.emplace_back(part.group.output,
                                                       static_cast<std::uint32_t>(place));
      }
      std::vector<Group> groups = group_by_output(part.group.candidates, *input);
      MAIDE_CHECK(!groups.empty());
      has_split = has_split || groups.size() > 1;
      // What is left of a word that tells some of all apart still does, as long as all are there.
      Witness rest;
      if (groups.size() == 1 && !part.witness.word.empty() && part.witness.word.front() == *input) {
        rest.word.assign(part.witness.word.begin() + 1, part.witness.word.end());
        rest.is_shortest = part.witness.is_shortest;
      }
      for (Group& group : groups) add(place, std::move(group), rest);
    }
    MAIDE_CHECK(result.nodes.empty() || has_split);
    return result;
  }

 private:
  // Nodes of the tree that are walked for a word before others are tried. Where inputs are counted,
  // long words are known of every state, and few tell some apart.
  static constexpr std::size_t most_witness_nodes = 4096;
  static constexpr std::size_t most_witnesses = 64;
  static constexpr std::size_t most_searches = 4096;  // kept

  // Suspects that gave the same output, as the nodes they came to.
  struct Group {
    Symbol output;
    std::vector<WeightedNode> candidates;
  };
  // A word that tells some of a group apart; empty: none was looked for, or there is none.
  struct Witness {
    Word word;
    bool is_shortest = false;
  };
  // What is to be asked after an output at a place in the result.
  struct Part {
    double weight;
    std::size_t number;
    std::size_t place;
    Group group;
    Witness witness;
    bool operator<(const Part& other) const {
      return std::pair(weight, other.number) < std::pair(other.weight, number);
    }
  };

  // An input that is known from a candidate.
  struct Answer {
    Symbol input, output;
    std::uint32_t candidate;
  };

  // Of the inputs that tell some apart at once the one of least estimated cost, one that is known
  // from all candidates if there is any: the others may need another query. If none tells some
  // apart, the first of a shortest word that does, which `witness` then is. As long as a shortest
  // word has several inputs, no single one tells any apart.
  std::optional<Symbol> choose_input(const std::vector<WeightedNode>& candidates,
                                     Witness& witness) {
    if (witness.is_shortest && witness.word.size() > 1) return witness.word.front();
    const auto first_of_witness = [&]() -> std::optional<Symbol> {
      if (witness.word.empty()) witness = choose_witness(candidates);
      if (witness.word.empty()) return std::nullopt;
      return witness.word.front();
    };
    if (candidates.size() == 2) {
      const std::optional<Symbol> input = tell_apart(candidates[0].node, candidates[1].node);
      return input ? input : first_of_witness();
    }
    collect_answers(candidates);
    std::optional<Symbol> best;
    bool is_best_known_from_all = false;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0, end = 0; begin < answers_.size(); begin = end) {
      const Symbol input = answers_[begin].input;
      end = first_answer_[input];
      const bool is_known_from_all = end - begin == candidates.size();
      if (is_best_known_from_all && !is_known_from_all) continue;
      const double cost = estimate(candidates, std::span(answers_).subspan(begin, end - begin));
      if (cost == std::numeric_limits<double>::infinity()) continue;
      if (cost >= least && is_known_from_all == is_best_known_from_all) continue;
      least = cost;
      best = input;
      is_best_known_from_all = is_known_from_all;
    }
    if (best) return best;
    return first_of_witness();
  }

  // The least input that two nodes answer differently.
  std::optional<Symbol> tell_apart(ObservationTree::Node left, ObservationTree::Node right) const {
    std::optional<Symbol> least;
    tree_.for_each_child(left, [&](ObservationTree::Node below) {
      const Symbol input = tree_.input(below);
      if (least && *least < input) return;
      const ObservationTree::Node other = tree_.child(right, input);
      if (other != ObservationTree::none && tree_.output(below) != tree_.output(other))
        least = input;
    });
    return least;
  }

  // Into answers_, by input, ascending; those to one input end at first_answer_[input].
  void collect_answers(const std::vector<WeightedNode>& candidates) {
    unsorted_.clear();
    std::ranges::fill(first_answer_, 0U);
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
      tree_.for_each_child(candidates[i].node, [&](ObservationTree::Node child) {
        unsorted_.push_back({tree_.input(child), tree_.output(child), i});
        ++first_answer_[tree_.input(child)];
      });
    }
    std::size_t sum = 0;
    for (std::size_t& first : first_answer_) sum += std::exchange(first, sum);
    MAIDE_CHECK(sum == unsorted_.size());
    answers_.resize(unsorted_.size());
    for (const Answer& answer : unsorted_) answers_[first_answer_[answer.input]++] = answer;
  }

  // Weight x symbols until one candidate is left, but for what is the same for all inputs; infinite
  // if the input tells no two apart at once.
  double estimate(const std::vector<WeightedNode>& candidates, std::span<const Answer> answers) {
    outputs_.clear();
    for (const Answer& answer : answers) {
      if (place_of_output_.size() <= answer.output) place_of_output_.resize(answer.output + 1);
      std::uint32_t& place = place_of_output_[answer.output];
      if (place >= outputs_.size() || outputs_[place].output != answer.output) {
        place = static_cast<std::uint32_t>(outputs_.size());
        outputs_.push_back({answer.output, 0, 0});
      }
      ++outputs_[place].candidates;
      outputs_[place].weight += candidates[answer.candidate].weight;
    }
    MAIDE_CHECK(!outputs_.empty() && outputs_.size() <= answers.size());
    if (outputs_.size() < 2) return std::numeric_limits<double>::infinity();
    double cost = 0;
    for (const Count& count : outputs_) {
      if (count.candidates > 1) {
        cost += count.weight * symbols_left(count.candidates);
      }
    }
    return cost;
  }

  // Estimated for so many candidates.
  double symbols_left(std::size_t candidates) {
    while (symbols_left_.size() <= candidates) {
      const auto count = static_cast<double>(std::max<std::size_t>(symbols_left_.size(), 1));
      symbols_left_.push_back((1 + std::log2(count)) / 2);
    }
    return symbols_left_[candidates];
  }

  // A word that tells two candidates apart, a shortest one unless that lies deep; empty if there is
  // none. Once some are told apart, what lies deep is left to another query.
  Witness choose_witness(const std::vector<WeightedNode>& candidates) {
    std::vector<ObservationTree::Node> nodes;
    for (const WeightedNode& candidate : candidates) nodes.push_back(candidate.node);
    if (known_.searches.size() >= most_searches) known_.searches.clear();
    const auto [found, is_new] = known_.searches.try_emplace(nodes);
    if (is_new) found->second = find_witness(nodes, most_witness_nodes);
    if (!found->second.was_cut || !must_split_) return {found->second.witness, true};
    for (const Word& word : known_.deep) {
      if (tells_apart(word, nodes)) return {word, false};
    }
    Word witness = find_witness(std::move(nodes), std::numeric_limits<std::size_t>::max()).witness;
    if (!witness.empty()) {
      known_.deep.push_front(witness);
      if (known_.deep.size() > most_witnesses) known_.deep.pop_back();
    }
    return {std::move(witness), true};
  }

  // Whether some of the nodes answer the word differently.
  bool tells_apart(const Word& word, std::vector<ObservationTree::Node> nodes) const {
    for (const Symbol input : word) {
      std::size_t kept = 0;
      for (const ObservationTree::Node node : nodes) {
        const ObservationTree::Node child = tree_.child(node, input);
        if (child == ObservationTree::none) continue;
        if (kept > 0 && tree_.output(nodes[0]) != tree_.output(child)) return true;
        nodes[kept++] = child;
      }
      if (kept < 2) return false;
      nodes.resize(kept);
    }
    return false;
  }

  // A shortest word, of these the least. All are walked together, so it costs the trees below them
  // and not the square of their number. Cut if there are more than `most_nodes` nodes.
  KnownWitnesses::Search find_witness(std::vector<ObservationTree::Node> nodes,
                                      std::size_t most_nodes) {
    struct Place {
      std::size_t parent;
      Symbol input;            // from the parent's nodes
      std::size_t begin, end;  // of nodes, to which one word leads, with the same outputs
    };
    std::vector<Place> queue{{0, 0, 0, nodes.size()}};
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const Place place = queue[next];
      if (place.end - place.begin >= most_nodes) return {{}, true};
      most_nodes -= place.end - place.begin;
      if (const auto input =
              look_below(std::span(nodes).subspan(place.begin, place.end - place.begin))) {
        Word witness{*input};
        for (std::size_t at = next; at != 0; at = queue[at].parent) {
          witness.push_back(queue[at].input);
        }
        std::ranges::reverse(witness);
        return {std::move(witness), false};
      }
      // By input; one that is known from one node alone tells nothing.
      std::ranges::sort(inputs_below_);
      std::size_t end = nodes.size();
      for (const Symbol input : inputs_below_) {
        Below& below = children_by_input_[input];
        if (below.count < 2) continue;
        below.place = end;
        end += below.count;
        queue.push_back({next, input, below.place, end});
      }
      nodes.resize(end);
      for (const auto& [input, child] : children_) {
        Below& below = children_by_input_[input];
        if (below.count > 1) nodes[below.place++] = child;
      }
    }
    return {};
  }

  // Into children_ those of these nodes, and how often each input leads to one. Returns the least
  // input that some of the nodes answer differently, if there is any.
  std::optional<Symbol> look_below(std::span<const ObservationTree::Node> nodes) {
    for (const Symbol input : inputs_below_) children_by_input_[input].count = 0;
    inputs_below_.clear();
    children_.clear();
    std::optional<Symbol> least;
    for (const ObservationTree::Node node : nodes) {
      tree_.for_each_child(node, [&](ObservationTree::Node child) {
        const Symbol input = tree_.input(child), output = tree_.output(child);
        Below& below = children_by_input_[input];
        if (below.count++ == 0) {
          inputs_below_.push_back(input);
          below.output = output;
        } else if (below.output != output && (!least || input < *least)) {
          least = input;
        }
        children_.emplace_back(input, child);
      });
    }
    return least;
  }

  std::vector<Group> group_by_output(const std::vector<WeightedNode>& candidates,
                                     Symbol input) const {
    std::vector<Group> groups;
    for (const WeightedNode& candidate : candidates) {
      const auto child = tree_.child(candidate.node, input);
      if (child == ObservationTree::none) continue;
      const Symbol output = tree_.output(child);
      auto group = std::ranges::find(groups, output, &Group::output);
      if (group == groups.end()) group = groups.insert(group, {output, {}});
      group->candidates.push_back({child, candidate.weight});
    }
    return groups;
  }

  // The children by one input of the nodes that are looked below.
  struct Below {
    std::size_t count = 0;
    Symbol output = 0;      // of the first of them
    std::size_t place = 0;  // where the next of them goes
  };
  struct Count {
    Symbol output;
    std::size_t candidates;
    double weight;
  };

  const ObservationTree& tree_;
  KnownWitnesses& known_;
  std::size_t parts_made_ = 0;
  bool must_split_ = true;
  std::vector<Answer> unsorted_, answers_;
  std::vector<std::size_t> first_answer_;  // by input: where its answers begin, then end
  std::vector<Below> children_by_input_;
  std::vector<Symbol> inputs_below_;  // those that have children there
  std::vector<std::pair<Symbol, ObservationTree::Node>> children_;
  std::vector<Count> outputs_;
  std::vector<double> symbols_left_;            // by number of candidates
  std::vector<std::uint32_t> place_of_output_;  // in outputs_, if it is there
};

}  // namespace

DecisionTree find_adaptive_sequence(const ObservationTree& tree,
                                    std::vector<WeightedNode> candidates, std::size_t most_inputs,
                                    KnownWitnesses* known) {
  KnownWitnesses nothing;
  return Planner(tree, known == nullptr ? nothing : *known)
      .plan(std::move(candidates), most_inputs);
}

}  // namespace maide
