// DOT as it is written: one line a state and an edge, in the order of the model, so that the same
// model always gives the same bytes.
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/moore.hpp"
#include "maide/formats/actors_text.hpp"
#include "maide/formats/dot.hpp"
#include "maide/formats/dot_syntax.hpp"
#include "maide/formats/names.hpp"

namespace maide {

namespace {

void write_attribute(std::ostream& out, const std::string& key, const std::string& value) {
  bool plain = !key.empty() && !(key[0] >= '0' && key[0] <= '9') && key != "node" &&
               key != "edge" && key != "graph" && key != "digraph" && key != "subgraph" &&
               key != "strict";
  for (const char letter : key) {
    plain = plain && ((letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                      (letter >= '0' && letter <= '9') || letter == '_');
  }
  out << "  " << (plain ? key : quote_dot_label(key)) << "=" << quote_dot_label(value) << ";\n";
}

// Everything before the states. `type` is written only where the labels would mislead a reader.
void write_head(std::ostream& out, const std::string& type, const Alphabet& inputs,
                const Alphabet& outputs, std::span<const Actor> actors,
                std::span<const std::string> hidden_returns, const Origin& origin) {
  out << "digraph g {\n";
  if (!type.empty()) write_attribute(out, "type", type);
  write_attribute(out, "inputs", join_names(inputs.names()));
  write_attribute(out, "outputs", join_names(outputs.names()));
  if (!actors.empty()) write_attribute(out, "actors", actors_to_text(actors));
  if (!hidden_returns.empty()) write_attribute(out, "hidden_returns", join_names(hidden_returns));
  for (const auto& [key, value] : origin) write_attribute(out, key, value);
  out << "  __start0 [label=\"\" shape=\"none\"];\n";
}

void write_state(std::ostream& out, StateId state, const std::string& more = {}) {
  out << "  s" << state << " [shape=\"circle\" label=\"s" << state << "\"" << more << "];\n";
}

void write_edge(std::ostream& out, StateId from, StateId to, const std::string& label,
                const char* more = "") {
  out << "  s" << from << " -> s" << to << " [label=" << quote_dot_label(label) << more << "];\n";
}

}  // namespace

namespace {

// States have outputs, edges have inputs alone; a DFA's accepting states are double circles.
void write_moore(std::ostream& out, const Mealy& machine, const std::vector<std::string>& outputs) {
  const bool is_dfa = machine.origin.at("type") == "dfa";
  write_head(out, "", machine.inputs(), machine.outputs(), machine.actors, {}, machine.origin);
  for (StateId state = 0; state < machine.size(); ++state) {
    const std::string name = "s" + std::to_string(state);
    const bool is_double = is_dfa && outputs[state] == accepting_output;
    out << "  " << name << " [shape=\"" << (is_double ? "doublecircle" : "circle")
        << "\" label=" << quote_dot_label(is_dfa ? name : mealy_label(name, outputs[state]))
        << "];\n";
  }
  out << "  __start0 -> s" << machine.initial() << ";\n";
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      write_edge(out, state, machine.target(state, input), machine.inputs().name(input));
    }
  }
  out << "}\n";
}

}  // namespace

void write_dot(std::ostream& out, const Mealy& machine) {
  if (!machine.is_complete()) throw UsageError("an incomplete Mealy machine cannot be written");
  if (find_initial_output(machine)) {
    const auto outputs = find_state_outputs(machine);
    if (outputs) return write_moore(out, machine, *outputs);
    const Mealy moore = split_states(machine);
    return write_moore(out, moore, *find_state_outputs(moore));
  }
  write_dot(out, NondeterministicMealy(machine));
}

void write_dot(std::ostream& out, const NondeterministicMealy& machine) {
  struct LabelledEdge {
    StateId from, to;
    std::string label;
  };
  std::vector<LabelledEdge> edges;
  std::vector<std::string_view> labels;
  edges.reserve(machine.transition_count());
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const auto& choice : machine.choices(state, input)) {
        edges.push_back(
            {state, choice.target,
             mealy_label(machine.inputs().name(input), machine.outputs().name(choice.output))});
      }
    }
  }
  for (const LabelledEdge& edge : edges) labels.push_back(edge.label);
  const bool misleads = looks_like_interface_automaton(labels);
  write_head(out, misleads ? "mealy" : "", machine.inputs(), machine.outputs(), machine.actors, {},
             machine.origin);
  for (StateId state = 0; state < machine.size(); ++state) write_state(out, state);
  out << "  __start0 -> s" << machine.initial() << ";\n";
  for (const LabelledEdge& edge : edges) write_edge(out, edge.from, edge.to, edge.label);
  out << "}\n";
}

void write_dot(std::ostream& out, const InterfaceAutomaton& automaton) {
  const bool misleads = automaton.transition_count() == 0;
  write_head(out, misleads ? "interface automaton" : "", automaton.inputs(), automaton.outputs(),
             automaton.actors, automaton.hidden_returns, automaton.origin);
  for (StateId state = 0; state < automaton.size(); ++state) {
    std::vector<std::string> unexplored;
    for (const Symbol input : automaton.unexplored(state)) {
      unexplored.push_back(automaton.inputs().name(input));
    }
    write_state(out, state,
                unexplored.empty()
                    ? ""
                    : " style=\"dashed\" unexplored=" + quote_dot_label(join_names(unexplored)));
  }
  out << "  __start0 -> s" << automaton.initial() << ";\n";
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      write_edge(out, state, transition.target, action_label(automaton, transition.action),
                 transition.absorbed ? " style=\"dashed\" absorbed=\"true\"" : "");
    }
  }
  out << "}\n";
}

void write_dot(std::ostream& out, const Model& model) {
  std::visit([&](const auto& automaton) { write_dot(out, automaton); }, model);
}

}  // namespace maide
