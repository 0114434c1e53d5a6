// A list and a stack that may become very large: their items lie in pieces of one size, so that
// growing moves nothing and holds nothing twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "maide/base/invariant.hpp"

namespace maide {

// A list. New elements are not initialised.
template <typename T>
class ChunkedList {
 public:
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return chunks_[i / chunk_items][i % chunk_items]; }
  void resize(std::size_t size) {
    while (chunks_.size() * chunk_items < size) {
      chunks_.push_back(std::make_unique_for_overwrite<T[]>(chunk_items));
    }
    size_ = size;
  }
  std::uint64_t bytes() const { return chunks_.size() * chunk_items * sizeof(T); }

 private:
  static constexpr std::size_t chunk_items = 4096;
  std::vector<std::unique_ptr<T[]>> chunks_;
  std::size_t size_ = 0;
};

// A stack. What is popped is given back.
template <typename Item>
class ChunkedStack {
 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }

  // Throws std::bad_alloc, and then nothing was pushed.
  void push(const Item& item) {
    if (size_ == chunks_.size() * chunk_items) {
      chunks_.push_back(std::make_unique_for_overwrite<Item[]>(chunk_items));
    }
    (*this)[size_] = item;
    ++size_;
  }
  Item& top() {
    MAIDE_CHECK(size_ > 0);
    return (*this)[size_ - 1];
  }
  void pop() { shrink_to(size_ - 1); }
  // Pops the items from number `size` on.
  void shrink_to(std::size_t size) {
    MAIDE_CHECK(size <= size_);
    size_ = size;
    // One empty piece is kept: the top may go up and down at its edge.
    while (chunks_.size() > size / chunk_items + 2) chunks_.pop_back();
  }
  Item& operator[](std::size_t index) { return chunks_[index / chunk_items][index % chunk_items]; }
  const Item& operator[](std::size_t index) const {
    return chunks_[index / chunk_items][index % chunk_items];
  }

  // What it holds, in bytes; `chunk_bytes`: what it grows by.
  std::uint64_t bytes() const { return chunks_.size() * chunk_bytes; }
  static constexpr std::size_t chunk_items = std::size_t{1} << 14;
  static constexpr std::uint64_t chunk_bytes = chunk_items * sizeof(Item);

 private:
  std::vector<std::unique_ptr<Item[]>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace maide
