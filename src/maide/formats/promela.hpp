// Models as Promela, SPIN's language, in the encoding of the paper: one process type for each
// automaton, which receives inputs on InChannel and emits outputs on OutChannel, both rendezvous
// channels and parameters of the type; each transition is one atomic step. Every state is a valid
// end state: a model may stop anywhere, it is the programs that deadlock.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// What an input does where it was never tried (unexplored, or an absorbed self-loop).
enum class PromelaUnexplored : std::uint8_t {
  stop,  // it is taken, and the process goes to the label end_unexplored, where it blocks
  wait,  // it is not possible
  drop,  // it is taken and nothing changes
};

struct PromelaProctypeOptions {
  // A Promela identifier or number for each symbol of the automaton's alphabets.
  std::vector<std::string> inputs, outputs;
  PromelaUnexplored unexplored = PromelaUnexplored::stop;
};

// `proctype NAME(chan InChannel; chan OutChannel) { ... }`. One pan state for each state (with
// `stop`, and something unexplored, one more). O(size).
void write_promela_proctype(std::ostream& out, const InterfaceAutomaton& automaton,
                            const std::string& name, const PromelaProctypeOptions& options);

// A complete file that spin runs: the model, declared names of its symbols, and an environment that
// does everything that the model lets it do. A Mealy machine answers each input by one output.
// Inputs that were never tried are taken and end in end_unexplored.
void write_promela(std::ostream& out, const Model& model);

}  // namespace maide
