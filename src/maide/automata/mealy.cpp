#include "maide/automata/mealy.hpp"

#include <atomic>
#include <utility>

namespace maide {
namespace {

// One that no row of the process has had. Each thread takes many at a time.
std::uint64_t new_revision() {
  constexpr std::uint64_t taken_at_once = 1 << 16;
  static std::atomic<std::uint64_t> taken{0};
  thread_local std::uint64_t last = 0;
  if (last % taken_at_once == 0) last = taken.fetch_add(taken_at_once, std::memory_order_relaxed);
  return ++last;
}

}  // namespace

Mealy::Mealy(Alphabet inputs, Alphabet outputs, std::size_t states)
    : inputs_(std::move(inputs)), outputs_(std::move(outputs)), size_(states) {
  cells_.resize(size_ * inputs_.size());
  revisions_.resize(size_);
}

StateId Mealy::add_state() {
  ++size_;
  cells_.resize(size_ * inputs_.size());
  revisions_.push_back(0);
  return static_cast<StateId>(size_ - 1);
}

void Mealy::set_transition(StateId from, Symbol input, Symbol output, StateId to) {
  cells_[index(from, input)] = {to, output};
  revisions_[from] = new_revision();
}

bool Mealy::is_complete() const {
  for (const Cell& cell : cells_) {
    if (cell.target == no_state) return false;
  }
  return true;
}

StateId Mealy::run(StateId from, std::span<const Symbol> word) const {
  for (const Symbol input : word) from = target(from, input);
  return from;
}

Word Mealy::output_word(StateId from, std::span<const Symbol> word) const {
  Word outputs;
  outputs.reserve(word.size());
  for (const Symbol input : word) {
    outputs.push_back(output(from, input));
    from = target(from, input);
  }
  return outputs;
}

}  // namespace maide
