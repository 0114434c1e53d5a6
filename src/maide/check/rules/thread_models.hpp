// What threads of nodes and executors share, as automata that no text names. They say which runs of
// a callback there are, which copies of a thread, and whether a node has started.
//
//   make_copies(1, false)   idle -run-> asked -begin1-> runs -end1-> idle, and `join` where it is
//   idle
#pragma once

#include <cstdint>

#include "maide/automata/interface_automaton.hpp"

namespace maide {

// Which runs of a callback there are, as a set of at most `count`: 2^count states. The first that
// is free starts. Inputs: start1, end1, start2, ...
InterfaceAutomaton make_runs(std::uint32_t count);

// Which of a thread's copies are asked to begin, and which run: 3^count states. `run` asks the
// first that is neither; `join` is possible where none is either. At first all are asked, or none.
InterfaceAutomaton make_copies(std::uint32_t count, bool are_asked);
enum class CopyInput : std::uint8_t { run, join, begin, end };  // the latter two of each copy
constexpr Symbol input_of_copy(CopyInput input, std::uint32_t copy = 0) {
  return static_cast<Symbol>(input) + 2 * copy;
}

// Nobody passes before it was opened.
InterfaceAutomaton make_gate();
inline constexpr Symbol gate_input_open = 0, gate_input_pass = 1;

}  // namespace maide
