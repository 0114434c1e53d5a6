#include "maide/learn/lsharp/observation_tree.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {

ObservationTree::Node ObservationTree::find(Node node, std::span<const Symbol> word) const {
  MAIDE_CHECK(node < nodes_.size());
  for (const Symbol input : word) {
    node = child(node, input);
    if (node == none) break;
  }
  return node;
}

ObservationTree::Inserted ObservationTree::insert(std::span<const Symbol> inputs,
                                                  std::span<const Symbol> outputs) {
  MAIDE_CHECK(inputs.size() == outputs.size());
  Inserted result;
  Node node = root;
  for (; result.known < inputs.size(); ++result.known) {
    const Node next = child(node, inputs[result.known]);
    if (next == none) break;
    if (output(next) != outputs[result.known]) {
      result.conflict = true;
      return result;
    }
    node = next;
  }
  for (std::size_t i = result.known; i < inputs.size(); ++i) {
    node = add_child(node, inputs[i], outputs[i]);
  }
  MAIDE_CHECK(result.known == inputs.size() || node + std::size_t{1} == nodes_.size());
  return result;
}

ObservationTree::Node ObservationTree::add_child(Node node, Symbol input, Symbol output) {
  MAIDE_CHECK(input < inputs_ && nodes_.size() < none);
  MAIDE_CHECK(this->child(node, input) == none);
  const Node child = static_cast<Node>(nodes_.size());
  Record record;
  record.input = input & 0x7fffffffU;
  record.output = output;
  if (nodes_[node].has_table) {
    tables_[nodes_[node].child + input] = child;
  } else {
    record.sibling = std::exchange(nodes_[node].child, child);
  }
  nodes_.push_back(record);
  return child;
}

void ObservationTree::make_table(Node node) {
  if (nodes_[node].has_table) return;
  const auto table = static_cast<Node>(tables_.size());
  tables_.resize(tables_.size() + inputs_, none);
  for (Node child = nodes_[node].child; child != none; child = nodes_[child].sibling) {
    MAIDE_CHECK(tables_[table + nodes_[child].input] == none);  // no input leaves it twice
    tables_[table + nodes_[child].input] = child;
  }
  nodes_[node].has_table = 1;
  nodes_[node].child = table;
}

bool ObservationTree::are_apart(Node left, Node right) const {
  MAIDE_CHECK(left < nodes_.size() && right < nodes_.size());
  while (true) {
    if (nodes_[left].has_table) std::swap(left, right);  // walk the list, look into the table
    // Of the pairs below, the last is walked in this loop: words are long, recursion is not deep.
    Node last_left = none, last_right = none;
    bool apart = false;
    for_each_child(left, [&](Node below) {
      if (apart) return;
      const Node other = child(right, input(below));
      if (other == none) return;
      apart =
          output(below) != output(other) || (last_left != none && are_apart(last_left, last_right));
      last_left = below;
      last_right = other;
    });
    if (apart || last_left == none) return apart;
    left = last_left;
    right = last_right;
  }
}

Word ObservationTree::find_witness(Node left, Node right) const {
  struct Pair {
    Node left, right;
    std::size_t parent;  // place in the queue of the pair before it
  };
  std::vector<Pair> queue{{left, right, 0}};
  std::vector<std::pair<Symbol, Node>> sorted;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    sorted.clear();
    for_each_child(queue[next].left, [&](Node below) { sorted.emplace_back(input(below), below); });
    std::ranges::sort(sorted);
    for (const auto& [symbol, below] : sorted) {
      const Node other = child(queue[next].right, symbol);
      if (other == none) continue;
      if (output(below) == output(other)) {
        queue.push_back({below, other, next});
        continue;
      }
      Word word{symbol};
      for (std::size_t at = next; at != 0; at = queue[at].parent) {
        word.push_back(input(queue[at].left));
      }
      std::ranges::reverse(word);
      MAIDE_CHECK(output(find(left, word)) != output(find(right, word)));
      return word;
    }
  }
  return {};
}

}  // namespace maide
