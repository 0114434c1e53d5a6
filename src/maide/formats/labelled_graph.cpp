#include "maide/formats/labelled_graph.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "maide/formats/names.hpp"

namespace maide {

namespace {

using Edge = LabelledGraph::Edge;

bool begins_like_action(std::string_view label) {
  return !label.empty() && (label.front() == '?' || label.front() == '!');
}

// A name at the end of a label, or all of one: plain, or quoted.
std::string unquote_whole(std::string_view text) {
  std::string name;
  std::string_view rest = text;
  if (!text.empty() && text.front() == '"' && take_quoted_name(rest, name) && rest.empty()) {
    return name;
  }
  return std::string(text);
}

bool needs_quotes_in_label(std::string_view name) {
  return name.empty() || name.front() == '"' || trim(name) != name || name == "/" ||
         name.find(" /") != std::string_view::npos || name.find("/ ") != std::string_view::npos;
}

std::string in_label(std::string_view name) {
  return needs_quotes_in_label(name) ? quote_name(name) : std::string(name);
}

// Where the separator of a label begins and ends: the only " / ", or else the only '/'. Names may
// contain slashes ("/camera/image / ok"), and are quoted where that leaves a doubt.
std::pair<std::size_t, std::size_t> find_separator(const LabelledGraph& graph, const Edge& edge,
                                                   std::string_view label) {
  const auto fail = [&](const std::string& why) {
    return ParseError("label " + shown(edge.label) + " " + why, graph.at(edge.place));
  };
  if (const std::size_t place = label.find(" / "); place != std::string_view::npos) {
    const bool quoted_output = place + 3 < label.size() && label[place + 3] == '"';
    if (!quoted_output && label.find(" / ", place + 1) != std::string_view::npos) {
      throw fail("has several \" / \": put names with a slash in quotes");
    }
    return {place, place + 3};
  }
  const std::size_t place = label.find('/');
  if (place == std::string_view::npos) throw fail("is not \"input / output\"");
  if (label.find('/', place + 1) != std::string_view::npos) {
    throw fail("has several '/': write \" / \" between input and output");
  }
  return {place, place + 1};
}

// Reads "input / output".
std::pair<std::string, std::string> split_mealy_label(const LabelledGraph& graph,
                                                      const Edge& edge) {
  const std::string_view label = trim(edge.label);
  std::string input;
  std::string_view rest = label;
  if (!label.empty() && label.front() == '"' && take_quoted_name(rest, input) &&
      trim(rest).starts_with('/')) {
    rest = trim(rest).substr(1);
  } else {
    const auto [begin, end] = find_separator(graph, edge, label);
    input = trim(label.substr(0, begin));
    rest = label.substr(end);
  }
  if (input.empty()) {
    throw ParseError("label " + shown(edge.label) + " has no input", graph.at(edge.place));
  }
  std::string output = unquote_whole(trim(rest));
  if (output.empty()) output = "quiet";  // nothing is emitted
  return {std::move(input), std::move(output)};
}

Symbol find_symbol(const LabelledGraph& graph, const Edge& edge, Alphabet& alphabet,
                   const std::string& name, bool declared, std::string_view what) {
  if (!declared) return alphabet.intern(name);
  if (const auto symbol = alphabet.find(name)) return *symbol;
  throw ParseError(std::string(what) + " " + shown(name) + " is not among the declared " +
                       std::string(what) + "s",
                   graph.at(edge.place));
}

Alphabet declared_alphabet(const std::optional<std::vector<std::string>>& names) {
  return names ? Alphabet(std::span<const std::string>(*names)) : Alphabet();
}

struct Step {
  Symbol input;
  Symbol output;
};

// Whether there is one transition for each state and input; the same one twice is one. Throws
// ParseError if two have the same output.
bool is_plain(const LabelledGraph& graph, const Alphabet& inputs, const std::vector<Step>& steps) {
  const auto cell = [&](std::size_t edge) {
    return std::size_t{graph.edges[edge].from} * inputs.size() + steps[edge].input;
  };
  std::vector<std::size_t> order(steps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t left, std::size_t right) {
    return std::pair(cell(left), steps[left].output) < std::pair(cell(right), steps[right].output);
  });
  bool is_single = true;
  std::size_t cells = 0;
  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::size_t edge = order[place];
    if (place == 0 || cell(edge) != cell(order[place - 1])) {
      ++cells;
      continue;
    }
    const std::size_t other = order[place - 1];
    if (steps[edge].output != steps[other].output) {
      is_single = false;
    } else if (graph.edges[edge].to != graph.edges[other].to) {
      throw ParseError("state " + shown(graph.states[graph.edges[edge].from].name) +
                           " has two transitions for input " +
                           shown(inputs.name(steps[edge].input)) + " with the same output",
                       graph.at(graph.edges[edge].place));
    }
  }
  return is_single && cells == graph.states.size() * inputs.size();
}

template <typename Machine>
Model finish(Machine machine, const LabelledGraph& graph) {
  machine.set_initial(graph.initial);
  machine.origin = graph.origin;
  if (!graph.hidden_returns.empty()) {
    machine.origin["hidden_returns"] = join_names(graph.hidden_returns);
  }
  machine.actors = graph.actors;
  return machine;
}

Model to_mealy_machine(const LabelledGraph& graph) {
  std::vector<Step> steps;
  steps.reserve(graph.edges.size());
  Alphabet inputs = declared_alphabet(graph.inputs);
  Alphabet outputs = declared_alphabet(graph.outputs);
  for (const Edge& edge : graph.edges) {
    const auto [input, output] = split_mealy_label(graph, edge);
    steps.push_back(
        {find_symbol(graph, edge, inputs, input, graph.inputs.has_value(), "input"),
         find_symbol(graph, edge, outputs, output, graph.outputs.has_value(), "output")});
  }
  check_size(graph, inputs.size());
  if (!is_plain(graph, inputs, steps)) {
    NondeterministicMealy machine(std::move(inputs), std::move(outputs), graph.states.size());
    for (std::size_t index = 0; index < graph.edges.size(); ++index) {
      const Edge& edge = graph.edges[index];
      machine.add_choice(edge.from, steps[index].input, steps[index].output, edge.to);
    }
    return finish(std::move(machine), graph);
  }
  Mealy machine(std::move(inputs), std::move(outputs), graph.states.size());
  for (std::size_t index = 0; index < graph.edges.size(); ++index) {
    const Edge& edge = graph.edges[index];
    machine.set_transition(edge.from, steps[index].input, steps[index].output, edge.to);
  }
  return finish(std::move(machine), graph);
}

InterfaceAutomaton to_interface_automaton_of(const LabelledGraph& graph) {
  Alphabet inputs = declared_alphabet(graph.inputs);
  Alphabet outputs = declared_alphabet(graph.outputs);
  std::vector<Action> actions;
  actions.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) {
    const std::string_view label = trim(edge.label);
    if (graph.has_opaque_labels) {
      actions.push_back({Action::Kind::input, inputs.intern(label)});
      continue;
    }
    if (!begins_like_action(label)) {
      throw ParseError("label " + shown(edge.label) + " is neither \"?input\" nor \"!output\"",
                       graph.at(edge.place));
    }
    const std::string name = unquote_whole(trim(label.substr(1)));
    if (name.empty()) {
      throw ParseError("label " + shown(edge.label) + " has no name", graph.at(edge.place));
    }
    const bool is_input = label.front() == '?';
    actions.push_back(
        is_input ? Action{Action::Kind::input,
                          find_symbol(graph, edge, inputs, name, graph.inputs.has_value(), "input")}
                 : Action{Action::Kind::output, find_symbol(graph, edge, outputs, name,
                                                            graph.outputs.has_value(), "output")});
    if (edge.absorbed && (!is_input || edge.from != edge.to)) {
      throw ParseError("only a self-loop of an input can be absorbed", graph.at(edge.place));
    }
  }
  for (const auto& state : graph.states) {
    for (const std::string& name : state.unexplored) {
      if (inputs.find(name)) continue;
      if (graph.inputs) {
        throw ParseError("unexplored input " + shown(name) + " is not among the declared inputs",
                         graph.at(state.place));
      }
      inputs.intern(name);
    }
  }
  InterfaceAutomaton automaton(inputs, outputs, graph.states.size());
  for (std::size_t index = 0; index < graph.edges.size(); ++index) {
    const Edge& edge = graph.edges[index];
    automaton.add_transition(edge.from, actions[index], edge.to, edge.absorbed);
  }
  for (StateId state = 0; state < graph.states.size(); ++state) {
    for (const std::string& name : graph.states[state].unexplored) {
      automaton.mark_unexplored(state, *inputs.find(name));
    }
  }
  automaton.set_initial(graph.initial);
  automaton.origin = graph.origin;
  automaton.actors = graph.actors;
  automaton.hidden_returns = graph.hidden_returns;
  return automaton;
}

bool is_interface_automaton(const LabelledGraph& graph) {
  if (graph.type) return *graph.type == "interface automaton";
  std::vector<std::string_view> labels;
  labels.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) labels.push_back(trim(edge.label));
  return looks_like_interface_automaton(labels);
}

}  // namespace

bool looks_like_interface_automaton(const std::vector<std::string_view>& labels) {
  if (labels.empty()) return false;
  return std::ranges::all_of(labels, begins_like_action) ||
         std::ranges::any_of(labels, [](std::string_view label) {
           return begins_like_action(label) && label.find('/') == std::string_view::npos;
         });
}

void check_size(const LabelledGraph& graph, std::size_t inputs) {
  constexpr std::size_t most_places = std::size_t{1} << 22;
  constexpr std::size_t most_places_an_edge = 256;
  const std::size_t places = graph.states.size() * inputs;
  if (places <= most_places + most_places_an_edge * graph.edges.size()) return;
  throw ParseError("a machine of " + std::to_string(graph.states.size()) + " states and " +
                       std::to_string(inputs) + " inputs, and hardly any transitions",
                   {graph.file, 0, 0});
}

std::optional<StateId> find_state(const LabelledGraph& graph, std::string_view name) {
  const auto found = std::ranges::find(graph.states, name, &LabelledGraph::State::name);
  if (found == graph.states.end()) return std::nullopt;
  return static_cast<StateId>(found - graph.states.begin());
}

bool has_other_labels(const LabelledGraph& graph) {
  if (graph.type) return false;
  const bool is_automaton = is_interface_automaton(graph);
  return std::ranges::any_of(graph.edges, [&](const Edge& edge) {
    const std::string_view label = trim(edge.label);
    return is_automaton ? !begins_like_action(label) : label.find('/') == std::string_view::npos;
  });
}

std::string mealy_label(std::string_view input, std::string_view output) {
  return in_label(input) + " / " + in_label(output);
}

std::string action_label(const InterfaceAutomaton& automaton, Action action) {
  const std::string& name = action.is_input() ? automaton.inputs().name(action.symbol)
                                              : automaton.outputs().name(action.symbol);
  const bool plain = !name.empty() && name.front() != '"' && trim(name) == name;
  return (action.is_input() ? "?" : "!") + (plain ? name : quote_name(name));
}

Model to_model(const LabelledGraph& graph) {
  if (graph.states.empty()) throw ParseError("the graph has no states", {graph.file, 0, 0});
  if (graph.has_opaque_labels) return to_interface_automaton_of(graph);
  if (is_interface_automaton(graph)) return to_interface_automaton_of(graph);
  return to_mealy_machine(graph);
}

}  // namespace maide
