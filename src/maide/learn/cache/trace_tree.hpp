// A tree of execution traces: each edge is an input and the output to it. It is the data structure
// under the cache, so it is small and quick. An edge takes 8 bytes. A node with more than one child
// has a block of child numbers besides. Together that is never above 16 bytes an edge (apart from
// chunks of memory that are not full yet).
//
// A node is known by the edge that leads to it. Its `link` is its only child, or the place of its
// block. A block is a small hash table of children by input. The number of its slots is a power of
// two, and a child lies at (input mod slots) or behind. A block as large as the alphabet is an
// array.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

class TraceTree {
 public:
  using Node = std::uint32_t;
  static constexpr Node root = 0;
  static constexpr Node none = ~Node{0};
  // Inputs and outputs must be below this.
  static constexpr Symbol symbol_limit = 0x8000;

  TraceTree();

  // The child of `node` by `input`, or none. O(1) on average.
  Node child(Node node, Symbol input) const {
    const std::uint32_t link = at(node).link;
    if (link == 0) return none;
    if ((link & block_flag) == 0) return at(link).input == input ? link : none;
    return find_in_block(block(link & ~block_flag), input);
  }
  // Follows several words from the root, as far as the tree knows each. Calls visit(i, node) for
  // every node that word i comes to, in the word's order. In a large tree each step waits for
  // memory, so the words take turns and wait together. O(their lengths) on average.
  template <typename Visit>
  void walk_together(std::span<const std::span<const Symbol>> words, Visit&& visit) const;

  // Input and output of the edge that leads to `node`, which is not the root.
  Symbol input(Node node) const { return at(node).input; }
  Symbol output(Node node) const { return at(node).output & ~mark_flag; }

  // A mark that users may set on nodes. Not set at first.
  bool is_marked(Node node) const { return (at(node).output & mark_flag) != 0; }
  void mark(Node node) {
    if (!is_marked(node)) at(node).output |= mark_flag;
  }

  // Takes all marks away. O(nodes).
  void unmark_all();

  // Adds the child of `node` by `input`, which has none yet. Throws Error if a symbol is too large
  // or the tree is full (2^31 edges). O(1) on average.
  Node add_child(Node node, Symbol input, Symbol output);

  // Corrects the output of the edge that leads to `node` and forgets everything below it. The
  // memory of what is forgotten is not used again. O(edges forgotten).
  void correct(Node node, Symbol output);

  // The children, by ascending input. O(children).
  void children(Node node, std::vector<Node>& result) const;

  // Nodes are numbered in the order in which they were added; this is the next one's number.
  Node next_node() const { return static_cast<Node>(size_); }

  std::uint64_t edge_count() const { return size_ - 1 - forgotten_; }
  // Memory held, in bytes.
  std::uint64_t bytes() const;

  // Throws std::logic_error unless every edge is found by its input, and none is lost. O(edges).
  void check_invariants() const;

 private:
  static constexpr std::uint32_t block_flag = 0x80000000;
  static constexpr std::uint16_t mark_flag = 0x8000;  // in `output`
  static constexpr std::uint32_t node_bits = 15;      // nodes in a chunk: 2^15, 256 KiB
  static constexpr std::uint32_t block_bits = 18;     // words in a chunk of blocks: 2^18, 1 MiB

  struct Record {
    std::uint32_t link = 0;  // 0: no child; flagged: place of a block; else: the only child
    std::uint16_t input = 0, output = 0;
  };
  static_assert(sizeof(Record) == 8);

  Record& at(Node node) { return nodes_[node >> node_bits][node & ((1u << node_bits) - 1)]; }
  const Record& at(Node node) const {
    return nodes_[node >> node_bits][node & ((1u << node_bits) - 1)];
  }
  // A block is its number of slots, then the slots: a child, or 0.
  std::uint32_t* block(std::uint32_t place) const {
    return &blocks_[place >> block_bits][place & ((1u << block_bits) - 1)];
  }
  Node find_in_block(const std::uint32_t* block, Symbol input) const {
    const std::uint32_t mask = block[0] - 1;
    for (std::uint32_t i = 0; i <= mask; ++i) {
      const Node child = block[1 + ((input + i) & mask)];
      if (child == 0) return none;
      if (at(child).input == input) return child;
    }
    return none;
  }
  bool insert_into_block(std::uint32_t* block, Node child);
  std::uint32_t allocate_block(std::uint32_t slots);
  void free_block(std::uint32_t place);

  std::vector<std::unique_ptr<Record[]>> nodes_;
  std::uint64_t size_ = 0;       // nodes, the root included
  std::uint64_t forgotten_ = 0;  // of these, cut off by correct()
  std::vector<std::unique_ptr<std::uint32_t[]>> blocks_;
  std::uint32_t block_end_ = 0;                          // words used of the blocks' chunks
  std::vector<std::vector<std::uint32_t>> free_blocks_;  // by logarithm of their slots
};

template <typename Visit>
void TraceTree::walk_together(std::span<const std::span<const Symbol>> words, Visit&& visit) const {
  struct Walk {
    std::size_t word;
    Node node;
    const std::uint32_t* slot;  // where the next child should be; null: `child` is the only one
    Node child;
  };
  constexpr std::size_t most = 16;  // about as many lines as a core fetches at once
  for (std::size_t start = 0; start < words.size(); start += most) {
    std::array<Walk, most> walks;
    std::size_t count = std::min(most, words.size() - start);
    for (std::size_t i = 0; i < count; ++i) walks[i] = {start + i, root, nullptr, none};
    for (std::size_t depth = 0; count > 0; ++depth) {
      for (std::size_t i = 0; i < count;) {
        Walk& walk = walks[i];
        const std::uint32_t link = depth < words[walk.word].size() ? at(walk.node).link : 0;
        if (link == 0) {
          walk = walks[--count];
          continue;
        }
        walk.slot = nullptr;
        if ((link & block_flag) == 0) {
          walk.child = link;
          __builtin_prefetch(&at(link));
        } else {
          const std::uint32_t* const children = block(link & ~block_flag);
          walk.slot = &children[1 + (words[walk.word][depth] & (children[0] - 1))];
          __builtin_prefetch(walk.slot);
        }
        ++i;
      }
      for (std::size_t i = 0; i < count; ++i) {
        if (walks[i].slot == nullptr) continue;
        walks[i].child = *walks[i].slot;
        __builtin_prefetch(&at(walks[i].child));
      }
      for (std::size_t i = 0; i < count;) {
        Walk& walk = walks[i];
        const Symbol input = words[walk.word][depth];
        // An empty slot is child 0, the root, whose input is none of an edge.
        if (walk.child == root || at(walk.child).input != input) {
          walk.child = walk.slot == nullptr || walk.child == root
                           ? none
                           : find_in_block(block(at(walk.node).link & ~block_flag), input);
          if (walk.child == none) {
            walk = walks[--count];
            continue;
          }
        }
        walk.node = walk.child;
        visit(walk.word, walk.node);
        ++i;
      }
    }
  }
}

}  // namespace maide
