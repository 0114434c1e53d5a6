#include "maide/learn/cache/trace_tree.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

TraceTree::TraceTree() {
  nodes_.push_back(std::make_unique<Record[]>(std::size_t{1} << node_bits));
  size_ = 1;
}

TraceTree::Node TraceTree::add_child(Node node, Symbol input, Symbol output) {
  MAIDE_CHECK(node < size_ && this->child(node, input) == none);
  if (input >= symbol_limit || output >= symbol_limit) {
    throw Error(ExitStatus::inconclusive, "the cache holds at most 32768 inputs and outputs");
  }
  if (size_ >= block_flag) {
    throw Error(ExitStatus::inconclusive, "the cache is full: it holds 2^31 observations");
  }
  if (size_ >> node_bits == nodes_.size()) {
    nodes_.push_back(std::make_unique<Record[]>(std::size_t{1} << node_bits));
  }
  const Node child = static_cast<Node>(size_++);
  at(child) = {0, static_cast<std::uint16_t>(input), static_cast<std::uint16_t>(output)};
  Record& parent = at(node);
  if (parent.link == 0) {
    parent.link = child;
    return child;
  }
  if ((parent.link & block_flag) == 0) {
    const std::uint32_t place = allocate_block(2);
    insert_into_block(block(place), parent.link);
    insert_into_block(block(place), child);
    parent.link = place | block_flag;
    MAIDE_CHECK(this->child(node, input) == child);
    return child;
  }
  const std::uint32_t old_place = parent.link & ~block_flag;
  if (insert_into_block(block(old_place), child)) return child;
  const std::uint32_t slots = block(old_place)[0];
  const std::uint32_t place = allocate_block(2 * slots);
  for (std::uint32_t i = 1; i <= slots; ++i) insert_into_block(block(place), block(old_place)[i]);
  insert_into_block(block(place), child);
  parent.link = place | block_flag;
  free_block(old_place);
  MAIDE_CHECK(this->child(node, input) == child);
  return child;
}

void TraceTree::unmark_all() {
  for (Node node = 0; node < size_; ++node) at(node).output &= mark_flag - 1;
}

void TraceTree::correct(Node node, Symbol output) {
  MAIDE_CHECK(node != root && node < size_);
  if (output >= symbol_limit) {
    throw Error(ExitStatus::inconclusive, "the cache holds at most 32768 inputs and outputs");
  }
  at(node).output = static_cast<std::uint16_t>(output | (at(node).output & mark_flag));
  std::vector<Node> work{node}, below;
  while (!work.empty()) {
    const Node next = work.back();
    work.pop_back();
    children(next, below);
    forgotten_ += below.size();
    work.insert(work.end(), below.begin(), below.end());
    const std::uint32_t link = std::exchange(at(next).link, 0);
    if ((link & block_flag) != 0) free_block(link & ~block_flag);
  }
  MAIDE_CHECK(forgotten_ < size_);
}

// False if the block is full.
bool TraceTree::insert_into_block(std::uint32_t* block, Node child) {
  const std::uint32_t mask = block[0] - 1;
  MAIDE_CHECK(std::has_single_bit(block[0]) && child != root);
  for (std::uint32_t i = 0; i <= mask; ++i) {
    std::uint32_t& slot = block[1 + ((at(child).input + i) & mask)];
    if (slot == 0) {
      slot = child;
      return true;
    }
  }
  return false;
}

std::uint32_t TraceTree::allocate_block(std::uint32_t slots) {
  const auto size_class = static_cast<std::size_t>(std::countr_zero(slots));
  std::uint32_t place = 0;
  if (size_class < free_blocks_.size() && !free_blocks_[size_class].empty()) {
    place = free_blocks_[size_class].back();
    free_blocks_[size_class].pop_back();
  } else {
    const std::uint32_t chunk_size = 1u << block_bits;
    const std::uint32_t used = block_end_ % chunk_size;
    if (used != 0 && used + slots + 1 > chunk_size) block_end_ += chunk_size - used;
    if (block_end_ >= block_flag - chunk_size) {
      throw Error(ExitStatus::inconclusive, "the cache is full: too many branches");
    }
    if (block_end_ >> block_bits == blocks_.size()) {
      blocks_.push_back(std::make_unique<std::uint32_t[]>(chunk_size));
    }
    place = block_end_;
    block_end_ += slots + 1;
  }
  MAIDE_CHECK(std::has_single_bit(slots) && place + slots < block_end_);
  MAIDE_CHECK((place >> block_bits) == ((place + slots) >> block_bits));  // all in one chunk
  std::uint32_t* fresh = block(place);
  fresh[0] = slots;
  std::fill(fresh + 1, fresh + 1 + slots, 0);
  return place;
}

void TraceTree::free_block(std::uint32_t place) {
  const auto size_class = static_cast<std::size_t>(std::countr_zero(block(place)[0]));
  if (free_blocks_.size() <= size_class) free_blocks_.resize(size_class + 1);
  free_blocks_[size_class].push_back(place);
}

void TraceTree::children(Node node, std::vector<Node>& result) const {
  result.clear();
  const std::uint32_t link = at(node).link;
  if (link == 0) return;
  if ((link & block_flag) == 0) {
    result.push_back(link);
    return;
  }
  const std::uint32_t* slots = block(link & ~block_flag);
  for (std::uint32_t i = 1; i <= slots[0]; ++i) {
    if (slots[i] != 0) result.push_back(slots[i]);
  }
  std::ranges::sort(result, [this](Node left, Node right) { return input(left) < input(right); });
}

void TraceTree::check_invariants() const {
  std::uint64_t edges = 0;
  std::vector<Node> below;
  for (std::vector<Node> open{root}; !open.empty();) {
    const Node node = open.back();
    open.pop_back();
    children(node, below);
    for (std::size_t i = 0; i < below.size(); ++i) {
      MAIDE_CHECK_ALWAYS(below[i] > node && below[i] < size_);
      MAIDE_CHECK_ALWAYS(child(node, input(below[i])) == below[i]);
      MAIDE_CHECK_ALWAYS(i == 0 || input(below[i - 1]) < input(below[i]));
    }
    edges += below.size();
    open.insert(open.end(), below.begin(), below.end());
  }
  MAIDE_CHECK_ALWAYS(edges == edge_count());
}

std::uint64_t TraceTree::bytes() const {
  return nodes_.size() * (sizeof(Record) << node_bits) +
         blocks_.size() * (sizeof(std::uint32_t) << block_bits);
}

}  // namespace maide
