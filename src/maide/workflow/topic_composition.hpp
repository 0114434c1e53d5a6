// The model of a whole topic, put together from a model of each reader: one automaton that does
// what the engine does with a topic (docs/systems.md). Comparing it with a model that was learned
// with all ends at once shows whether a middleware's topic is made of its readers.
//
//   write, write2   go to the models of all readers, or to one that takes it
//   read2           goes to the second reader's
//   written2        is due when all models have it due, and goes to whoever wrote
//
// As a learned model, the result takes no input while an output is due.
#pragma once

#include <cstddef>
#include <span>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

struct TopicShape {
  std::size_t writers = 1;
  bool delivers_one = false;  // a write goes to one of the models that take it
};

// Each reader's model is one of one writer and one reader, and names its actors, of which one is
// the "writer". Symbols of the second writer and of the second reader's model have a 2 behind their
// names. Throws UsageError, and Interrupted. O(product of the models' sizes x writers).
InterfaceAutomaton compose_topic(std::span<const InterfaceAutomaton> readers,
                                 const TopicShape& shape, const RunControl& control = {});

}  // namespace maide
