// What the readers of all file formats have in common: making a model of a graph with labelled
// edges. Labels like "input / output" make a Mealy machine. Labels like "?input" and "!output" make
// an interface automaton. A Mealy machine with several answers to an input is nondeterministic, one
// that has none to some is partial.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/error.hpp"

namespace maide {

using Model = std::variant<Mealy, InterfaceAutomaton, NondeterministicMealy>;

struct LabelledGraph {
  struct State {
    std::string name;  // as in the file, for messages
    TextPlace place;
    std::vector<std::string> unexplored;
  };
  struct Edge {
    StateId from = 0;
    StateId to = 0;
    std::string label;
    TextPlace place;
    bool absorbed = false;
  };

  std::string file;  // for messages
  std::vector<State> states;
  std::vector<Edge> edges;
  StateId initial = 0;
  std::optional<std::string> type;  // "mealy" or "interface automaton" where the file says so
  bool has_opaque_labels = false;   // labels are inputs, and may be anything
  std::optional<std::vector<std::string>> inputs, outputs;  // where the file declares them
  std::vector<Actor> actors;
  std::vector<std::string> hidden_returns;
  Origin origin;

  SourcePosition at(TextPlace place) const { return {file, place.line, place.column}; }
};

// Throws ParseError with its place for a label of neither form, for a symbol that is missing from
// an alphabet that the file declares, and for a Mealy machine that is not observable (two
// transitions with the same input and output). Alphabets that are not declared are in order of
// appearance. A Mealy machine that is partial or nondeterministic is a NondeterministicMealy.
Model to_model(const LabelledGraph& graph);

// The labels as the writers write them.
std::string mealy_label(std::string_view input, std::string_view output);
std::string action_label(const InterfaceAutomaton& automaton, Action action);

// A machine is a table with a place for each state and input, and a file of a few bytes may promise
// a huge one. Throws ParseError if it is far larger than the graph.
void check_size(const LabelledGraph& graph, std::size_t inputs);
std::optional<StateId> find_state(const LabelledGraph& graph, std::string_view name);

// Whether some label is of neither form: the file is a transition system of another kind.
bool has_other_labels(const LabelledGraph& graph);

// True if these labels alone suggest an interface automaton: every label begins with ? or !, or one
// does and has no '/'. False if there are no labels.
bool looks_like_interface_automaton(const std::vector<std::string_view>& labels);

}  // namespace maide
