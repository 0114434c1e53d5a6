// Mealy machines: deterministic and complete, so in each state each input gives one output and one
// next state. A plain value type. Transitions lie in one flat table (state-major), so a step is one
// load. Moore machines and DFAs are Mealy machines with a mark (the end of this file).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

using StateId = std::uint32_t;

// Where a model came from: graph attributes of its file (sul, bound, versions, tests, seed, ...).
// The alphabets, actors and hidden returns have fields of their own and do not appear here.
using Origin = std::map<std::string, std::string>;

// A named thread of the system that makes its blocking calls: it takes its inputs one at a time and
// is the source of its outputs. Each input and each output belongs to at most one actor.
struct Actor {
  std::string name;
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  bool operator==(const Actor&) const = default;
};

class Mealy {
 public:
  static constexpr StateId no_state = ~StateId{0};
  // A transition of a state by an input.
  struct Cell {
    StateId target = no_state;
    Symbol output = 0;
    bool operator==(const Cell&) const = default;
  };

  Mealy() = default;
  // `states` states numbered from 0, state 0 initial, no transitions yet.
  Mealy(Alphabet inputs, Alphabet outputs, std::size_t states);

  const Alphabet& inputs() const { return inputs_; }
  const Alphabet& outputs() const { return outputs_; }
  Symbol intern_output(std::string_view name) { return outputs_.intern(name); }

  std::size_t size() const { return size_; }
  StateId initial() const { return initial_; }
  void set_initial(StateId state) { initial_ = state; }
  StateId add_state();

  void set_transition(StateId from, Symbol input, Symbol output, StateId to);
  StateId target(StateId from, Symbol input) const { return cells_[index(from, input)].target; }
  Symbol output(StateId from, Symbol input) const { return cells_[index(from, input)].output; }
  // The transitions of a state, by input.
  std::span<const Cell> row(StateId from) const {
    return std::span(cells_).subspan(index(from, 0), inputs_.size());
  }
  // Identifies the contents of the row. Rows with the same number are the same, in this machine at
  // any time and in its copies. Setting a transition makes a new number.
  std::uint64_t revision(StateId state) const { return revisions_[state]; }
  // Every state has a transition for every input. O(size x inputs).
  bool is_complete() const;

  // The state reached from `from` by `word`. O(length).
  StateId run(StateId from, std::span<const Symbol> word) const;
  StateId run(std::span<const Symbol> word) const { return run(initial_, word); }
  // The outputs along `word`, as many as it has symbols. O(length).
  Word output_word(StateId from, std::span<const Symbol> word) const;
  Word output_word(std::span<const Symbol> word) const { return output_word(initial_, word); }

  Origin origin;              // where the model came from
  std::vector<Actor> actors;  // empty where the system has none

 private:
  std::size_t index(StateId from, Symbol input) const {
    return std::size_t{from} * inputs_.size() + input;
  }
  Alphabet inputs_, outputs_;
  std::size_t size_ = 0;
  StateId initial_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint64_t> revisions_;  // by state; 0: no transition was ever set
};

// ---- Moore machines and DFAs ----
//
// In a Moore machine a transition's output is that of the state it leads to. A DFA's outputs are
// "accept" and "reject". So both are Mealy machines, and any learner of these learns them. The
// output of the initial state is lost, because no input shows it. It is kept in `origin`, with the
// kind ("type": "moore" or "dfa").
//
// Two Moore states that differ in their own output alone are one state of the minimal Mealy
// machine. split_states() makes two of it again. The result is the minimal Moore machine.

inline constexpr const char* accepting_output = "accept";  // of a DFA's states
inline constexpr const char* rejecting_output = "reject";

// The output of the initial state, where the machine stands for a Moore machine or DFA.
std::optional<std::string> find_initial_output(const Mealy& machine);
// Says that the machine stands for one: `type` is "moore" or "dfa".
void mark_as_moore(Mealy& machine, const std::string& type, const std::string& initial_output);

// The output of each state: that of all transitions into it, and of the initial state the one that
// the machine is marked with. Nothing if it is not marked, or a state would have two outputs.
// A state that no transition leads to has the initial one's. O(n k).
std::optional<std::vector<std::string>> find_state_outputs(const Mealy& machine);

// An equivalent machine, marked alike, whose states have one output each, reachable states only, in
// breadth-first order; minimal as a Moore machine if `machine` is minimal. `machine` must be marked
// and complete. O(n k times the outputs of a state).
Mealy split_states(const Mealy& machine);

}  // namespace maide
