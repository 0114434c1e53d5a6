// Small machines for exhaustive tests.
#pragma once

#include <cstdint>

#include "maide/automata/mealy.hpp"

namespace maide {

// Number of machines of this many states, with two inputs and two outputs.
inline std::uint64_t count_small_machines(std::uint64_t states) {
  std::uint64_t count = 1;
  for (std::uint64_t cell = 0; cell < 2 * states; ++cell) count *= 2 * states;
  return count;
}

// The machine of this number; not all of its states need be reachable.
inline Mealy small_machine(std::uint64_t states, std::uint64_t number) {
  Mealy machine({"a", "b"}, {"0", "1"}, states);
  for (StateId state = 0; state < states; ++state) {
    for (Symbol input = 0; input < 2; ++input) {
      const std::uint64_t cell = number % (2 * states);
      number /= 2 * states;
      machine.set_transition(state, input, static_cast<Symbol>(cell % 2),
                             static_cast<StateId>(cell / 2));
    }
  }
  return machine;
}

}  // namespace maide
