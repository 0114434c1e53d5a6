// A control program as an automaton. Each transition is one step: an input given to a model
// instance, an output taken from one, a `quiet` observed, or an internal choice made. `loop`,
// `repeat`, `skip` and labels cost no step; `repeat` is unrolled. Every transition knows its place
// in the system file. A plain value type. Transitions lie in one flat table, so that 10^6 control
// states fit.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/language/scalar_text.hpp"

namespace maide {

using ControlState = std::uint32_t;

struct ProgramEdge {
  enum class Kind : std::uint8_t {
    give,    // gives input `symbol` to instance `model`
    take,    // takes output `symbol` of instance `model`
    quiet,   // sees that instance `model` has no output due
    choice,  // takes branch number `symbol` of an `if *`
  };
  Kind kind = Kind::choice;
  std::uint32_t model = 0;
  Symbol symbol = 0;
  ControlState target = 0;
  int line = 0, column = 0;  // in the system file
};

struct Program {
  struct State {
    std::uint32_t first_edge = 0;
    std::uint32_t edge_count = 0;
    std::uint32_t label_set = 0;  // index into label_sets
    std::uint32_t round = 0;      // index into rounds: of the innermost loop
  };
  // A round of a `loop` or `repeat`, in one round of each loop around it.
  struct Round {
    std::uint32_t outer = 0;   // the round around it; 0: none
    int line = 0, column = 0;  // of the loop
    std::uint32_t number = 0;  // from 1; 0 in a `loop`, whose rounds are all the same
    std::uint32_t count = 0;   // of the `repeat`; 0 in a `loop`
    bool operator==(const Round&) const = default;
  };
  std::string name;
  SourcePosition position;                             // of the program in the system file
  int last_line = 0;                                   // of its text there
  std::vector<State> states;                           // state 0 is the initial one
  std::vector<ProgramEdge> edges;                      // grouped by state
  std::vector<std::string> labels;                     // names, in the order of the text
  std::vector<std::vector<std::uint32_t>> label_sets;  // [0] is empty; each sorted
  std::vector<Round> rounds;                           // [0] is outside of every loop
  std::vector<SourcePosition> unreachable;  // statements behind one that does not come to its end

  std::span<const ProgramEdge> edges_of(ControlState state) const {
    return std::span(edges).subspan(states[state].first_edge, states[state].edge_count);
  }
  // The program has ended. A program's other states always have a transition.
  bool is_end(ControlState state) const { return states[state].edge_count == 0; }
  bool has_label(ControlState state, std::uint32_t label) const;
  // What control can come to, whatever the models do. O(control states).
  bool may_end() const;
  bool may_reach(std::uint32_t label) const;
};

// A model instance as a program's text sees it.
struct ProgramInterface {
  std::string name;
  const Alphabet* inputs = nullptr;
  const Alphabet* outputs = nullptr;
};

// Most control states of one program after unrolling.
inline constexpr std::size_t max_control_states = 1'000'000;

// Parses a program and unrolls it. Names are checked against the instances' alphabets. Throws
// ParseError with the place in the file: syntax, unknown names, a loop that never steps, more than
// max_control_states. O(control states).
//
// The language (names that are no identifiers are in double quotes; comments run from `//` or `#`
// to the end of the line):
//   statement := label* ( M.input; | M.input -> output; | switch M.input { arm* }
//              | wait M -> output; | loop block | repeat N block
//              | if * block [ else block ] | skip; | stop; )
//   arm := (output | quiet) block      block := { statement* }      label := @name
// A label on a statement that takes no step of its own (`skip`, `stop`, an empty `repeat`) marks
// the point: it holds where control comes to rest.
Program parse_program(const std::string& name, const ScalarText& text,
                      std::span<const ProgramInterface> models);

}  // namespace maide
