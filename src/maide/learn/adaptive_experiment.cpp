#include "maide/learn/adaptive_experiment.hpp"

#include <algorithm>
#include <utility>

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
    node = branch->second;
  }
  return nodes;
}

}  // namespace

DecisionTree chain(std::span<const Symbol> inputs, std::span<const Symbol> outputs) {
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
    graft(tree, nodes_along(tree, outcome).back(), outcome.back(), subtree);
  }
}

Word inputs_along(const DecisionTree& tree, std::span<const Symbol> outcome) {
  Word inputs;
  for (const std::size_t node : nodes_along(tree, outcome)) {
    inputs.push_back(tree.nodes[node].input);
  }
  return inputs;
}

}  // namespace maide
