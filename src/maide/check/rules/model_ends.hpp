// What becomes of a model because programs stand at its ends. The model of one reader of a topic
// collects what is due to the writers, until they take it from all readers' models. An end whose
// program may die can be left: what is due to it, then or later, is thrown away, and the model
// takes `disconnect` if it has that. A reader's model can leave its topic.
//
// The result is an automaton whose states are a state of the model, what was collected, and for
// each end whether something due to it is still to be thrown away. That is kept only where it may
// still come, so a model that nobody left has no more states than before.
// Cost: O(states x outputs of the writer x 4^ends), of which only those that are met are made.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// An end whose program may die.
struct ModelEnd {
  std::vector<bool> inputs, outputs;  // by symbol: those of its actor, and of `disconnect`
  std::optional<Symbol> disconnect;   // an input that the model takes when the end dies
};

// The end number `place` (from 0) of the `count` at that actor: those of "writer" have `write`,
// `write2`, `write3`. An input `disconnect` belongs to it if its actor has it, or one that is none
// of `others`.
ModelEnd find_end(const InterfaceAutomaton& model, const std::string& actor, std::size_t place,
                  std::size_t count, const std::set<std::string>& others);

struct EndedModel {
  InterfaceAutomaton automaton;
  std::vector<std::optional<Symbol>> collected;  // by state: the output that the writers may take
  std::vector<StateId> cleared;                  // by state: behind the taking
  std::optional<StateId> gone;                   // the reader died
  // By end, by state: what the end's death does. Nothing where the state stays.
  std::vector<std::vector<std::vector<ModelStep>>> deaths;
};

struct EndOptions {
  bool collects = false;                                  // outputs of the actor "writer"
  bool may_leave = false;                                 // the reader may die
  std::vector<ModelEnd> ends;                             // that may die
  WhenUnexplored when_unexplored = WhenUnexplored::stop;  // of `disconnect`
};
// Throws UsageError if it is to collect and the model does not name its actors.
EndedModel with_ends(const InterfaceAutomaton& model, const EndOptions& options);

}  // namespace maide
