// Draws an input of a state, each with a weight of its own: Walker's alias method ("An efficient
// method for generating discrete random variables with general distributions", ACM TOMS 1977;
// tables after Vose, IEEE TSE 1991).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"

namespace maide {

class WeightedInputs {
 public:
  // Of each state, then input; positive. There must be an input. O(n k).
  WeightedInputs(std::span<const double> weights, std::size_t input_count);
  // O(1).
  Symbol draw(StateId state, Random& random) const;

 private:
  // One of k equally likely slots of a state: the slot's own input, or another.
  struct Slot {
    std::uint32_t threshold;  // own if 32 random bits are below
    Symbol other;
  };
  std::size_t input_count_;
  std::vector<Slot> slots_;  // by state, then input
};

// Each transition weighs 1 over the number of transitions that lead where it leads. O(n k).
std::vector<double> compute_off_sink_weights(const Mealy& machine);

// Each next state of a state weighs 1 over the number of states that lead to it, shared by the
// transitions that lead there. O(n k).
std::vector<double> compute_off_loop_weights(const Mealy& machine);

}  // namespace maide
