#include "maide/learn/tree/discrimination_tree.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"

namespace maide {

DiscriminationTree::DiscriminationTree() {
  leaf_.push_back(root);
  nodes_.emplace_back();
  nodes_[root].state = 0;
}

DiscriminationTree::Node DiscriminationTree::child(Node node,
                                                   std::span<const Symbol> answer) const {
  MAIDE_CHECK(!is_leaf(node));
  const std::vector<Node>& children = nodes_[node].children;
  const auto found = std::lower_bound(
      children.begin(), children.end(), answer, [&](Node child, std::span<const Symbol> wanted) {
        return std::ranges::lexicographical_compare(nodes_[child].label, wanted);
      });
  if (found == children.end() || !std::ranges::equal(nodes_[*found].label, answer)) return none;
  return *found;
}

Word DiscriminationTree::inputs_to(Node node) const {
  MAIDE_CHECK(node != root && has_question(parent(node)));
  const Record& above = nodes_[nodes_[node].parent];
  return above.suffix.empty() ? inputs_along(above.experiment, nodes_[node].label) : above.suffix;
}

StateId DiscriminationTree::representative(Node node) const {
  while (!is_leaf(node)) node = nodes_[node].children.front();
  return state(node);
}

std::vector<StateId> DiscriminationTree::states_below(Node node) const {
  std::vector<StateId> states;
  for_each_leaf(node, [&](Node leaf) { states.push_back(state(leaf)); });
  return states;
}

DiscriminationTree::Node DiscriminationTree::common_ancestor(Node left, Node right) const {
  const auto depth = [&](Node node) {
    std::size_t result = 0;
    for (; nodes_[node].parent != none; node = nodes_[node].parent) ++result;
    return result;
  };
  std::size_t left_depth = depth(left), right_depth = depth(right);
  for (; left_depth > right_depth; --left_depth) left = nodes_[left].parent;
  for (; right_depth > left_depth; --right_depth) right = nodes_[right].parent;
  while (left != right) {
    MAIDE_CHECK(left != root && right != root);
    left = nodes_[left].parent;
    right = nodes_[right].parent;
  }
  return left;
}

DiscriminationTree::Node DiscriminationTree::child_towards(Node ancestor, Node below) const {
  while (below != none && nodes_[below].parent != ancestor) below = nodes_[below].parent;
  return below;
}

DiscriminationTree::Node DiscriminationTree::block_of(Node node) const {
  Node block = node;
  for (; node != none; node = nodes_[node].parent) {
    if (nodes_[node].temporary) block = node;
  }
  return block;
}

void DiscriminationTree::for_each_leaf(Node node, const std::function<void(Node)>& visit) const {
  std::vector<Node> open{node};
  while (!open.empty()) {
    node = open.back();
    open.pop_back();
    if (is_leaf(node)) visit(node);
    open.insert(open.end(), nodes_[node].children.rbegin(), nodes_[node].children.rend());
  }
}

DiscriminationTree::Node DiscriminationTree::add_node(Record record) {
  if (free_.empty()) {
    nodes_.push_back(std::move(record));
    return static_cast<Node>(nodes_.size() - 1);
  }
  const Node node = free_.back();
  free_.pop_back();
  nodes_[node] = std::move(record);
  return node;
}

void DiscriminationTree::release(Node node) {
  MAIDE_CHECK(node != root && !is_leaf(node));  // states keep their leaves
  nodes_[node] = {};
  free_.push_back(node);
}

void DiscriminationTree::hang(Node parent, Node child, Word label) {
  std::vector<Node>& children = nodes_[parent].children;
  const auto place =
      std::upper_bound(children.begin(), children.end(), label,
                       [&](const Word& left, Node right) { return left < nodes_[right].label; });
  MAIDE_CHECK(parent != child && !is_leaf(parent));
  // One child for each answer, of the length of what was asked.
  MAIDE_CHECK(!has_question(parent) || place == children.begin() ||
              nodes_[*(place - 1)].label != label);
  MAIDE_CHECK(nodes_[parent].suffix.empty() || label.size() == nodes_[parent].suffix.size());
  children.insert(place, child);
  nodes_[child].parent = parent;
  nodes_[child].label = std::move(label);
}

DiscriminationTree::Node DiscriminationTree::add_leaf(Node parent, Word label) {
  Record record;
  record.state = static_cast<StateId>(leaf_.size());
  const Node leaf = add_node(std::move(record));
  leaf_.push_back(leaf);
  hang(parent, leaf, std::move(label));
  return leaf;
}

void DiscriminationTree::split(Node leaf, Inner inner, Word label) {
  MAIDE_CHECK(is_leaf(leaf) && leaf_[nodes_[leaf].state] == leaf);
  MAIDE_CHECK(inner.suffix.empty() || inner.experiment.nodes.empty());
  Record record;
  record.state = std::exchange(nodes_[leaf].state, Mealy::no_state);
  const Node lower = add_node(std::move(record));
  leaf_[nodes_[lower].state] = lower;
  nodes_[leaf].suffix = std::move(inner.suffix);
  nodes_[leaf].rest = inner.rest;
  nodes_[leaf].temporary = inner.temporary;
  nodes_[leaf].experiment = std::move(inner.experiment);
  hang(leaf, lower, std::move(label));
}

// The part of a subtree that holds the chosen states, without nodes that tell none of
// them apart; none if it holds none. Leaves move, inner nodes are copied.
DiscriminationTree::Node DiscriminationTree::extract(Node source, const std::vector<bool>& chosen) {
  if (is_leaf(source)) return chosen[nodes_[source].state] ? source : none;
  std::vector<std::pair<Node, Word>> parts;
  for (const Node child : nodes_[source].children) {
    Word label = nodes_[child].label;  // before the child moves
    const Node part = extract(child, chosen);
    if (part != none) parts.emplace_back(part, std::move(label));
  }
  if (parts.empty()) return none;
  if (parts.size() == 1) return parts.front().first;
  Record record;
  record.suffix = nodes_[source].suffix;
  record.rest = nodes_[source].rest;
  record.temporary = nodes_[source].temporary;
  record.experiment = nodes_[source].experiment;
  const Node copy = add_node(std::move(record));
  for (auto& [part, label] : parts) hang(copy, part, std::move(label));
  return copy;
}

// The parts of a subtree by what their states answer. Its inner nodes but the uppermost are gone.
std::vector<std::pair<DiscriminationTree::Node, Word>> DiscriminationTree::regroup(
    Node node, const std::function<Word(StateId)>& answer) {
  std::map<Word, std::vector<StateId>> groups;
  for_each_leaf(node, [&](Node leaf) { groups[answer(state(leaf))].push_back(state(leaf)); });
  std::vector<Node> old_nodes;  // inner nodes below
  for (std::vector<Node> open{node}; !open.empty();) {
    const Node next = open.back();
    open.pop_back();
    if (is_leaf(next)) continue;
    if (next != node) old_nodes.push_back(next);
    open.insert(open.end(), nodes_[next].children.begin(), nodes_[next].children.end());
  }
  std::vector<std::pair<Node, Word>> parts;
  std::vector<bool> chosen(leaf_.size());
  for (const auto& [label, states] : groups) {
    for (const StateId state : states) chosen[state] = true;
    parts.emplace_back(extract(node, chosen), label);
    MAIDE_CHECK(parts.back().first != none && parts.back().first != node);
    for (const StateId state : states) chosen[state] = false;
  }
  for (const Node old_node : old_nodes) release(old_node);
  nodes_[node].children.clear();
  return parts;
}

void DiscriminationTree::finalise(Node block, Inner inner,
                                  const std::function<Word(StateId)>& answer) {
  MAIDE_CHECK(inner.suffix.empty() != inner.experiment.nodes.empty());
  const std::vector<std::pair<Node, Word>> parts = regroup(block, answer);
  MAIDE_CHECK(parts.size() > 1);  // the question tells some apart
  nodes_[block].suffix = std::move(inner.suffix);
  nodes_[block].rest = inner.rest;
  nodes_[block].temporary = inner.temporary;
  nodes_[block].experiment = std::move(inner.experiment);
  for (const auto& [part, label] : parts) hang(block, part, label);
}

void DiscriminationTree::lengthen(Node node, DecisionTree experiment,
                                  const std::function<Word(StateId)>& answer) {
  const Node above = parent(node);
  MAIDE_CHECK(node != root && !is_leaf(node) && !nodes_[above].experiment.nodes.empty());
  const std::vector<std::pair<Node, Word>> parts = regroup(node, answer);
  MAIDE_CHECK(parts.size() > 1);
  // The experiment goes on: so each answer goes on after the old one.
  MAIDE_CHECK(std::ranges::all_of(parts, [&](const auto& part) {
    return part.second.size() > label(node).size() &&
           std::ranges::equal(head(part.second, label(node).size()), label(node));
  }));
  std::erase(nodes_[above].children, node);
  release(node);
  nodes_[above].experiment = std::move(experiment);
  for (const auto& [part, label] : parts) hang(above, part, label);
}

void DiscriminationTree::check_invariants() const {
  std::vector<bool> is_reached(nodes_.size(), false);
  std::size_t states = 0;
  for (std::vector<Node> open{root}; !open.empty();) {
    const Node node = open.back();
    open.pop_back();
    MAIDE_CHECK_ALWAYS(!is_reached.at(node));
    is_reached[node] = true;
    const Record& record = nodes_[node];
    if (is_leaf(node)) {
      MAIDE_CHECK_ALWAYS(record.children.empty() && !has_question(node));
      MAIDE_CHECK_ALWAYS(leaf_.at(record.state) == node);
      ++states;
      continue;
    }
    check_inner(node);
    for (const Node child : record.children) {
      MAIDE_CHECK_ALWAYS(nodes_.at(child).parent == node);
      open.push_back(child);
    }
  }
  MAIDE_CHECK_ALWAYS(states == leaf_.size() && nodes_[root].parent == none);
  for (const Node node : free_) {
    MAIDE_CHECK_ALWAYS(!is_reached.at(node));
    is_reached[node] = true;
  }
  MAIDE_CHECK_ALWAYS(std::ranges::count(is_reached, false) == 0);
}

// A question, and children in the order of different answers to it.
void DiscriminationTree::check_inner(Node node) const {
  const Record& record = nodes_[node];
  MAIDE_CHECK_ALWAYS(record.suffix.empty() || record.experiment.nodes.empty());
  MAIDE_CHECK_ALWAYS(has_question(node) || record.temporary);
  MAIDE_CHECK_ALWAYS(!record.children.empty());
  for (std::size_t i = 0; i < record.children.size(); ++i) {
    const Word& label = nodes_[record.children[i]].label;
    if (!has_question(node)) continue;
    MAIDE_CHECK_ALWAYS(i == 0 || nodes_[record.children[i - 1]].label < label);
    MAIDE_CHECK_ALWAYS(inputs_to(record.children[i]).size() == label.size());
  }
  if (record.rest == none) return;
  MAIDE_CHECK_ALWAYS(tail(record.suffix, 1) == nodes_.at(record.rest).suffix);
  MAIDE_CHECK_ALWAYS(!is_temporary(record.rest));
}

}  // namespace maide
