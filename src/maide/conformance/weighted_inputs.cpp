#include "maide/conformance/weighted_inputs.hpp"

#include <numeric>

namespace maide {

WeightedInputs::WeightedInputs(std::span<const double> weights, std::size_t input_count)
    : input_count_(input_count), slots_(weights.size()) {
  std::vector<double> share(input_count);  // of each slot's probability, those of its input
  std::vector<Symbol> small, large;
  for (std::size_t first = 0; first < weights.size(); first += input_count) {
    const std::span<const double> own = weights.subspan(first, input_count);
    const double scale =
        static_cast<double>(input_count) / std::accumulate(own.begin(), own.end(), 0.0);
    for (Symbol input = 0; input < input_count; ++input) {
      share[input] = own[input] * scale;
      (share[input] < 1 ? small : large).push_back(input);
    }
    Slot* const slots = &slots_[first];
    while (!small.empty() && !large.empty()) {
      const Symbol poor = small.back(), rich = large.back();
      small.pop_back();
      slots[poor] = {static_cast<std::uint32_t>(share[poor] * 0x1p32), rich};
      share[rich] -= 1 - share[poor];
      if (share[rich] < 1) {
        large.pop_back();
        small.push_back(rich);
      }
    }
    for (std::vector<Symbol>* rest : {&small, &large}) {  // full, but for rounding
      for (const Symbol input : *rest) slots[input] = {0xffffffff, input};
      rest->clear();
    }
  }
}

Symbol WeightedInputs::draw(StateId state, Random& random) const {
  // The bias of a product of 32 bits is below k / 2^32.
  const std::uint64_t bits = random();
  const auto input = static_cast<Symbol>((bits >> 32) * input_count_ >> 32);
  const Slot& slot = slots_[state * input_count_ + input];
  return static_cast<std::uint32_t>(bits) < slot.threshold ? input : slot.other;
}

std::vector<double> compute_off_sink_weights(const Mealy& machine) {
  std::vector<double> leading(machine.size(), 0);  // transitions to each state
  for (StateId state = 0; state < machine.size(); ++state) {
    for (const Mealy::Cell& cell : machine.row(state)) ++leading[cell.target];
  }
  std::vector<double> weights;
  weights.reserve(machine.size() * machine.inputs().size());
  for (StateId state = 0; state < machine.size(); ++state) {
    for (const Mealy::Cell& cell : machine.row(state)) weights.push_back(1 / leading[cell.target]);
  }
  return weights;
}

std::vector<double> compute_off_loop_weights(const Mealy& machine) {
  // To each state: the states that lead there, and the transitions from the state at hand.
  std::vector<double> leading(machine.size(), 0), parallel(machine.size(), 0);
  const auto count_parallel = [&](StateId state) {
    for (const Mealy::Cell& cell : machine.row(state)) parallel[cell.target] = 0;
    for (const Mealy::Cell& cell : machine.row(state)) ++parallel[cell.target];
  };
  for (StateId state = 0; state < machine.size(); ++state) {
    count_parallel(state);
    for (const Mealy::Cell& cell : machine.row(state)) {
      leading[cell.target] += 1 / parallel[cell.target];
    }
  }
  std::vector<double> weights;
  weights.reserve(machine.size() * machine.inputs().size());
  for (StateId state = 0; state < machine.size(); ++state) {
    count_parallel(state);
    for (const Mealy::Cell& cell : machine.row(state)) {
      weights.push_back(1 / (leading[cell.target] * parallel[cell.target]));
    }
  }
  return weights;
}

}  // namespace maide
