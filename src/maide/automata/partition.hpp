// A refinable partition of the numbers below n: the data structure of partition refinement, which
// splits blocks and never joins them (Hopcroft, "An n log n algorithm for minimizing states in a
// finite automaton", 1971; as arrays: Valmari & Lehtinen, "Efficient minimization of DFAs with
// partial transition functions", STACS 2008).
//
// One array holds the elements. A block is a range of it, and its marked elements come first. To
// split them off moves a boundary, and costs as much as there are marks. A refinement that marks
// the predecessors of all parts of a block but the largest looks at each element O(log n) times.
//
// Invariants: no range is empty, and together they cover the array; each element knows its place
// and its block.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"

namespace maide {

class Partition {
 public:
  using Element = std::uint32_t;
  using Block = std::uint32_t;

  // All elements in block 0; no block if there are none. 12 bytes an element and 12 a block.
  explicit Partition(std::size_t elements);

  // The number of blocks; they are 0, 1, ... in the order in which they were made.
  Block blocks() const { return static_cast<Block>(begin_.size()); }
  Block block_of(Element element) const { return block_of_[element]; }
  std::size_t size(Block block) const { return end_[block] - begin_[block]; }
  // Valid until the next call that marks or splits.
  std::span<const Element> elements(Block block) const {
    return {elements_.data() + begin_[block], size(block)};
  }

  // Marks an element; returns true if it is the first marked one of its block. O(1).
  bool mark(Element element) {
    const Block block = block_of_[element];
    const std::uint32_t boundary = begin_[block] + marked_[block];
    MAIDE_CHECK(boundary <= end_[block] && elements_[place_[element]] == element);
    if (place_[element] < boundary) return false;
    const Element other = elements_[boundary];
    std::swap(elements_[place_[element]], elements_[boundary]);
    std::swap(place_[element], place_[other]);
    return marked_[block]++ == 0;
  }

  // Splits the marked elements off into a new block and unmarks them. Returns the new block, or
  // `block` itself if all of it was marked, or nothing. O(marked elements).
  Block split(Block block);

  // Splits the block, which has no marks, by the keys of its elements. The least key keeps the
  // block, and each other key makes a new one, in ascending order. Returns the least new block, or
  // blocks() if there is one key. Elements ascend in each part. O(s log s) for s elements.
  template <typename KeyOf>
  Block split_by(Block block, KeyOf&& key_of) {
    MAIDE_CHECK(marked_[block] == 0);
    const Block first_new = blocks();
    using Key = std::decay_t<std::invoke_result_t<KeyOf&, Element>>;
    std::vector<std::pair<Key, Element>> keyed;
    keyed.reserve(size(block));
    for (const Element element : elements(block)) keyed.emplace_back(key_of(element), element);
    const auto is_first_key = [&](const auto& entry) { return entry.first == keyed.front().first; };
    if (std::ranges::all_of(keyed, is_first_key)) return first_new;
    std::ranges::sort(keyed);
    std::uint32_t place = begin_[block];
    for (std::size_t i = 0; i < keyed.size(); ++i, ++place) {
      if (i > 0 && keyed[i].first != keyed[i - 1].first) block = cut(block, place);
      put(keyed[i].second, place, block);
    }
    MAIDE_CHECK(place == end_[block] && blocks() > first_new);
    return first_new;
  }

  // Throws std::logic_error where an invariant does not hold. O(n).
  void check_invariants() const;

 private:
  // Makes the range of the block end at `place`, and a new block of its rest.
  Block cut(Block block, std::uint32_t place);
  void put(Element element, std::uint32_t place, Block block) {
    elements_[place] = element;
    place_[element] = place;
    block_of_[element] = block;
  }

  std::vector<Element> elements_;           // by place
  std::vector<std::uint32_t> place_;        // by element
  std::vector<Block> block_of_;             // by element
  std::vector<std::uint32_t> begin_, end_;  // by block: its range of elements_
  std::vector<std::uint32_t> marked_;       // by block: so many elements at its begin are marked
};

// Splits until the elements of each block have equal signatures (Kanellakis & Smolka, PODC 1983).
// `signature(element)` reads the blocks of the element's successors from `partition`. At worst n
// rounds of n signatures.
template <typename Signature>
void refine_by_signatures(Partition& partition, Signature&& signature) {
  for (Partition::Block before = 0; before != partition.blocks();) {
    before = partition.blocks();
    for (Partition::Block block = 0; block < before; ++block) {
      if (partition.size(block) > 1) partition.split_by(block, signature);
    }
  }
}

}  // namespace maide
