#include "maide/automata/mealy.hpp"

#include <utility>

namespace maide {

Mealy::Mealy(Alphabet inputs, Alphabet outputs, std::size_t states)
    : inputs_(std::move(inputs)), outputs_(std::move(outputs)), size_(states) {
  cells_.resize(size_ * inputs_.size());
}

StateId Mealy::add_state() {
  ++size_;
  cells_.resize(size_ * inputs_.size());
  return static_cast<StateId>(size_ - 1);
}

void Mealy::set_transition(StateId from, Symbol input, Symbol output, StateId to) {
  cells_[index(from, input)] = {to, output};
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
