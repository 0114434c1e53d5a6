#include "maide/formats/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <ostream>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/file.hpp"
#include "maide/formats/dot_syntax.hpp"
#include "maide/formats/names.hpp"

namespace maide {

Model read_model(const std::filesystem::path& path, const ModelReading& reading) {
  const std::string extension = path.extension().string();
  if (extension == ".dot" || extension == ".gv") {
    return read_dot(read_regular_file(path), path.string(), reading);
  }
  if (extension == ".aut") return read_aut(read_regular_file(path), path.string(), reading);
  throw UsageError("a model's file ends in .dot, .gv or .aut (" + path.string() + ")");
}

Mealy read_mealy(const std::filesystem::path& path) { return take_mealy(read_model(path), path); }

Mealy take_mealy(Model model, const std::filesystem::path& path) {
  if (auto* machine = std::get_if<Mealy>(&model)) return std::move(*machine);
  if (const auto* machine = std::get_if<NondeterministicMealy>(&model)) {
    throw UsageError("a " + std::string(name_of_kind(model)) + " where a " +
                     (machine->is_deterministic() ? "complete" : "deterministic") +
                     " one is needed (" + path.string() + ")");
  }
  throw UsageError("an interface automaton where a Mealy machine is needed (" + path.string() +
                   ")");
}

void note_labels(const ModelReading& reading, LabelledGraph& graph) {
  using Labels = ModelReading::Labels;
  graph.has_opaque_labels = reading.labels == Labels::any ||
                            (reading.labels == Labels::any_where_needed && has_other_labels(graph));
  if (graph.has_opaque_labels) graph.origin["labels"] = "opaque";
}

bool has_opaque_labels(const Model& model) {
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr) return false;
  const auto labels = automaton->origin.find("labels");
  return labels != automaton->origin.end() && labels->second == "opaque";
}

void set_initial(const ModelReading& reading, LabelledGraph& graph) {
  if (reading.initial.empty()) return;
  const auto state = find_state(graph, reading.initial);
  if (!state) {
    throw ParseError("there is no state " + shown(reading.initial) + " to begin in",
                     {graph.file, 0, 0});
  }
  graph.initial = *state;
}

std::string_view name_of_kind(const Model& model) {
  if (std::holds_alternative<InterfaceAutomaton>(model)) return "interface automaton";
  const auto* machine = std::get_if<NondeterministicMealy>(&model);
  if (machine == nullptr) return "Mealy machine";
  const bool is_partial = !machine->is_complete();
  if (machine->is_deterministic()) return is_partial ? "partial Mealy machine" : "Mealy machine";
  return is_partial ? "partial nondeterministic Mealy machine" : "nondeterministic Mealy machine";
}

InterfaceAutomaton read_interface_automaton(const std::filesystem::path& path) {
  Model model = read_model(path);
  if (auto* automaton = std::get_if<InterfaceAutomaton>(&model)) return std::move(*automaton);
  throw UsageError("a Mealy machine where an interface automaton is needed (" + path.string() +
                   ")");
}

// DOT as it is read: both labelled forms, with the graph attributes that keep where a model came
// from. What a foreign file lacks is worked out from its edges.

namespace {

// Attributes that say how to draw the graph: not where the model came from.
constexpr std::array drawing_attributes = {
    "_background", "bb",       "bgcolor",  "center",     "charset",     "class",     "clusterrank",
    "color",       "comment",  "compound", "dpi",        "fillcolor",   "fontcolor", "fontname",
    "fontsize",    "id",       "label",    "labeljust",  "labelloc",    "landscape", "layout",
    "lp",          "margin",   "nodesep",  "ordering",   "outputorder", "overlap",   "pad",
    "page",        "pencolor", "penwidth", "rank",       "rankdir",     "ranksep",   "ratio",
    "rotate",      "splines",  "style",    "stylesheet", "tooltip",     "URL",       "viewport"};

class DotReader {
 public:
  DotReader(std::string_view text, const std::string& file, const ModelReading& reading)
      : dot_(parse_dot(text, file)), reading_(reading) {
    graph_.file = file;
  }

  Model read() {
    read_graph_attributes();
    find_start_marks();
    read_nodes();
    read_edges();
    const bool has_state_outputs = is_moore();
    find_marked_state();
    if (!has_state_outputs) {
      note_labels(reading_, graph_);
      return to_model(graph_);
    }
    put_outputs_on_edges();
    Model model = to_model(graph_);
    auto* machine = std::get_if<Mealy>(&model);
    if (machine == nullptr) {
      const bool is_partial = std::get<NondeterministicMealy>(model).is_deterministic();
      throw ParseError(
          fmt::format("a {} has one transition for each input in each state, and "
                      "this one has {}",
                      is_dfa_ ? "DFA" : "Moore machine", is_partial ? "none for some" : "several"),
          {graph_.file, 1, 1});
    }
    mark_as_moore(*machine, is_dfa_ ? "dfa" : "moore", outputs_[graph_.initial]);
    return model;
  }

 private:
  using Attribute = DotGraph::Attribute;

  // Runs `parse` on an attribute's text; its complaint gets the attribute's place.
  template <typename Parse>
  auto placed(const Attribute& attribute, Parse parse) const {
    try {
      return parse(unescape_dot_label(attribute.value));
    } catch (const UsageError& error) {
      throw ParseError("attribute " + shown(attribute.key) + ": " + error.what(),
                       graph_.at(attribute.place));
    }
  }
  std::vector<std::string> names(const Attribute& attribute) const {
    return placed(attribute, [](const std::string& text) { return split_names(text); });
  }
  std::vector<std::string> alphabet(const Attribute& attribute) const {
    return placed(attribute, [](const std::string& text) {
      std::vector<std::string> list = split_names(text);
      [[maybe_unused]] const Alphabet checked{
          std::span<const std::string>(list)};  // names are distinct
      return list;
    });
  }

  void read_graph_attributes() {
    std::unordered_set<std::string_view> later;
    for (auto list = dot_.attributes; list != no_dot_attributes; list = dot_.arena[list].older) {
      const Attribute& attribute = dot_.arena[list];
      if (!later.insert(attribute.key).second) continue;  // it is overwritten
      const std::string value = unescape_dot_label(attribute.value);
      if (attribute.key == "inputs") {
        graph_.inputs = alphabet(attribute);
      } else if (attribute.key == "outputs") {
        graph_.outputs = alphabet(attribute);
      } else if (attribute.key == "hidden_returns") {
        graph_.hidden_returns = names(attribute);
      } else if (attribute.key == "actors") {
        graph_.actors =
            placed(attribute, [](const std::string& text) { return actors_from_text(text); });
      } else if (attribute.key == "type" && (value == "mealy" || value == "interface automaton")) {
        graph_.type = value;
      } else if (attribute.key == strength_key) {
        placed(attribute, [](const std::string& text) { return parse_stated_strength(text); });
        graph_.origin.emplace(attribute.key, value);
      } else if (std::ranges::find(drawing_attributes, attribute.key) == drawing_attributes.end()) {
        graph_.origin.emplace(unescape_dot_label(attribute.key), value);
      }
    }
  }

  bool has_label(const DotGraph::Edge& edge) const {
    const Attribute* label = dot_.find(edge.attributes, "label");
    return label != nullptr && !trim(unescape_dot_label(label->value)).empty();
  }

  // Nodes that are no states, but mark one: those with a name for it, and those that no edge leads
  // to and that one edge without a label leaves.
  void find_start_marks() {
    is_mark_.assign(dot_.nodes.size(), false);
    std::vector<std::uint32_t> in(dot_.nodes.size()), out(dot_.nodes.size());
    std::vector<bool> is_labelled(dot_.nodes.size());
    bool has_labels = false;
    for (const DotGraph::Edge& edge : dot_.edges) {
      ++in[edge.to];
      ++out[edge.from];
      if (!has_label(edge)) continue;
      is_labelled[edge.from] = has_labels = true;
    }
    for (std::size_t node = 0; node < dot_.nodes.size(); ++node) {
      const std::string& name = dot_.nodes[node].name;
      is_mark_[node] = name == "__start0" || name == "__start" || name == "__init" ||
                       (has_labels && in[node] == 0 && out[node] == 1 && !is_labelled[node]);
    }
  }

  void read_nodes() {
    for (std::size_t index = 0; index < dot_.nodes.size(); ++index) {
      const DotGraph::Node& node = dot_.nodes[index];
      if (is_mark_[index]) {
        numbers_.push_back(Mealy::no_state);
        continue;
      }
      numbers_.push_back(static_cast<StateId>(graph_.states.size()));
      LabelledGraph::State state{node.name, node.place, {}};
      if (const Attribute* mark = dot_.find(node.attributes, "unexplored")) {
        state.unexplored = names(*mark);
      }
      graph_.states.push_back(std::move(state));
    }
  }

  void read_edges() {
    const DotGraph::Edge* start = nullptr;
    for (const DotGraph::Edge& edge : dot_.edges) {
      const SourcePosition position = graph_.at(edge.place);
      if (numbers_[edge.to] == Mealy::no_state) {
        throw ParseError("an edge leads to " + shown(dot_.nodes[edge.to].name) +
                             ", which only marks the initial state",
                         position);
      }
      if (numbers_[edge.from] == Mealy::no_state) {
        if (start != nullptr && start->to != edge.to) {
          throw ParseError("a second initial state", position);
        }
        start = &edge;
        is_marked_ = true;
        graph_.initial = numbers_[edge.to];
        continue;
      }
      const Attribute* label = dot_.find(edge.attributes, "label");
      if (label == nullptr) throw ParseError("an edge without a label", position);
      const Attribute* absorbed = dot_.find(edge.attributes, "absorbed");
      if (absorbed != nullptr && absorbed->value != "true" && absorbed->value != "false") {
        throw ParseError("absorbed is neither \"true\" nor \"false\"", graph_.at(absorbed->place));
      }
      graph_.edges.push_back({numbers_[edge.from], numbers_[edge.to],
                              unescape_dot_label(label->value), label->place,
                              absorbed != nullptr && absorbed->value == "true"});
    }
  }

  // The state that was asked for; or where no node marks the initial one, what else does.
  void find_marked_state() {
    if (!is_marked_) find_own_mark();
    set_initial(reading_, graph_);
  }
  void find_own_mark() {
    const auto named = graph_.origin.find("initial");
    const auto state =
        named == graph_.origin.end() ? std::nullopt : find_state(graph_, named->second);
    if (state) {
      graph_.initial = *state;
      graph_.origin.erase(named);
      return;
    }
    const auto has_mark = [&](const DotGraph::Node& node) {
      return std::ranges::any_of(state_marks, [&](const char* key) {
        const Attribute* mark = dot_.find(node.attributes, key);
        return mark != nullptr && mark->value != "false";
      });
    };
    const auto has_rings = [&](const DotGraph::Node& node) {
      const Attribute* rings = dot_.find(node.attributes, "peripheries");
      return is_accepting(node) || (rings != nullptr && rings->value == "2");
    };
    if (!begin_in_the_only(has_mark) && !is_dfa_) begin_in_the_only(has_rings);
  }
  // False if there is none of that kind, or several.
  template <typename Predicate>
  bool begin_in_the_only(Predicate&& is_marked) {
    std::optional<StateId> found;
    for (std::size_t index = 0; index < dot_.nodes.size(); ++index) {
      if (is_mark_[index] || !is_marked(dot_.nodes[index])) continue;
      if (found) return false;
      found = numbers_[index];
    }
    if (found) graph_.initial = *found;
    return found.has_value();
  }

  // A DFA has edges with inputs alone and a double circle for each accepting state, a Moore machine
  // an output in each state's label: "s0 / output", or "s0|output" as others write it.
  bool is_moore() {
    const auto type = graph_.origin.find("type");
    const bool is_said = type != graph_.origin.end() && type->second == "moore";
    is_dfa_ = type != graph_.origin.end() && type->second == "dfa";
    if (is_said || is_dfa_) return true;
    for (const LabelledGraph::Edge& edge : graph_.edges) {
      if (edge.label.find('/') != std::string::npos) return false;
      if (edge.label.starts_with('?') || edge.label.starts_with('!')) return false;
    }
    bool has_outputs = !graph_.states.empty();
    for (std::size_t index = 0; index < dot_.nodes.size(); ++index) {
      if (is_mark_[index]) continue;
      const DotGraph::Node& node = dot_.nodes[index];
      is_dfa_ = is_dfa_ || is_accepting(node);
      has_outputs = has_outputs && state_output(node).has_value();
    }
    return is_dfa_ || has_outputs;
  }

  bool is_accepting(const DotGraph::Node& node) const {
    const Attribute* shape = dot_.find(node.attributes, "shape");
    return shape != nullptr && shape->value == "doublecircle";
  }

  std::optional<std::string> state_output(const DotGraph::Node& node) const {
    const Attribute* label = dot_.find(node.attributes, "label");
    if (label == nullptr) return std::nullopt;
    std::string text = unescape_dot_label(label->value);
    // The fields of a record may stand in braces.
    if (text.starts_with('{') && text.ends_with('}')) text = text.substr(1, text.size() - 2);
    const std::size_t slash = text.find(" / ");
    const std::size_t place = slash == std::string::npos ? text.find('|') : slash + 2;
    if (place == std::string::npos || place + 1 >= text.size()) return std::nullopt;
    std::string_view rest = trim(std::string_view(text).substr(place + 1));
    std::string name;
    if (rest.starts_with('"') && take_quoted_name(rest, name)) return name;
    return std::string(rest);
  }

  void put_outputs_on_edges() {
    for (std::size_t index = 0; index < dot_.nodes.size(); ++index) {
      if (is_mark_[index]) continue;
      const DotGraph::Node& node = dot_.nodes[index];
      if (is_dfa_) {
        outputs_.emplace_back(is_accepting(node) ? accepting_output : rejecting_output);
      } else if (auto output = state_output(node)) {
        outputs_.push_back(*std::move(output));
      } else {
        throw ParseError("state " + shown(node.name) + " of a Moore machine has no output",
                         graph_.at(node.place));
      }
    }
    if (is_dfa_) reject_what_is_missing();
    for (LabelledGraph::Edge& edge : graph_.edges) {
      edge.label = mealy_label(trim(edge.label), outputs_[edge.to]);
    }
    graph_.type = "mealy";
  }

  // A word for which a DFA has no transition is rejected, and so is what comes behind it.
  void reject_what_is_missing() {
    std::set<std::string> inputs;
    std::set<std::pair<StateId, std::string>> known;
    if (graph_.inputs) inputs.insert(graph_.inputs->begin(), graph_.inputs->end());
    for (LabelledGraph::Edge& edge : graph_.edges) {
      inputs.emplace(trim(edge.label));
      known.emplace(edge.from, trim(edge.label));
    }
    check_size(graph_, inputs.size());
    if (known.size() == graph_.states.size() * inputs.size()) return;
    const auto sink = static_cast<StateId>(graph_.states.size());
    const TextPlace place = graph_.states.front().place;
    for (StateId state = 0; state <= sink; ++state) {
      for (const std::string& input : inputs) {
        if (!known.contains({state, input})) graph_.edges.push_back({state, sink, input, place});
      }
    }
    graph_.states.push_back({"(rejected)", place, {}});
    outputs_.emplace_back(rejecting_output);
  }

  static constexpr std::array state_marks = {"initial", "init", "start", "root"};

  DotGraph dot_;
  const ModelReading& reading_;
  std::vector<bool> is_mark_;  // by node
  bool is_marked_ = false;     // the initial state, by a node
  bool is_dfa_ = false;
  std::vector<std::string> outputs_;  // by state, of a Moore machine
  LabelledGraph graph_;
  std::vector<StateId> numbers_;  // of each node; no_state for the mark of the initial state
};

}  // namespace

Model read_dot(std::string_view text, const std::string& file, const ModelReading& reading) {
  return DotReader(text, file, reading).read();
}

// DOT as it is written: one line a state and an edge, in the order of the model, so that the same
// model always gives the same bytes.

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

void write_start(std::ostream& out) { out << "  __start0 [label=\"\" shape=\"none\"];\n"; }

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
  write_start(out);
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

namespace {

struct LabelledEdge {
  StateId from, to;
  std::string label;
};

std::vector<LabelledEdge> edges_of(const NondeterministicMealy& machine) {
  std::vector<LabelledEdge> edges;
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
  return edges;
}

// Everything behind the head.
void write_graph(std::ostream& out, const NondeterministicMealy& machine,
                 const std::vector<LabelledEdge>& edges) {
  for (StateId state = 0; state < machine.size(); ++state) write_state(out, state);
  out << "  __start0 -> s" << machine.initial() << ";\n";
  for (const LabelledEdge& edge : edges) write_edge(out, edge.from, edge.to, edge.label);
  out << "}\n";
}

// Without the spaces, which some readers take for parts of the names. A name with a slash needs
// them.
void join_tightly(std::string& label) {
  const std::size_t place = label.find(" / ");
  if (label.find('/') == place + 1 && label.rfind('/') == place + 1) label.replace(place, 3, "/");
}

}  // namespace

void write_dot(std::ostream& out, const NondeterministicMealy& machine) {
  const std::vector<LabelledEdge> edges = edges_of(machine);
  std::vector<std::string_view> labels;
  for (const LabelledEdge& edge : edges) labels.push_back(edge.label);
  const bool misleads = looks_like_interface_automaton(labels);
  write_head(out, misleads ? "mealy" : "", machine.inputs(), machine.outputs(), machine.actors, {},
             machine.origin);
  write_graph(out, machine, edges);
}

void write_automata_wiki(std::ostream& out, const Model& model) {
  if (std::holds_alternative<InterfaceAutomaton>(model)) {
    throw UsageError("the Automata Wiki's form is one of Mealy machines");
  }
  const auto* deterministic = std::get_if<Mealy>(&model);
  const NondeterministicMealy machine = deterministic != nullptr
                                            ? NondeterministicMealy(*deterministic)
                                            : std::get<NondeterministicMealy>(model);
  out << "digraph g {\n";
  write_start(out);
  std::vector<LabelledEdge> edges = edges_of(machine);
  for (LabelledEdge& edge : edges) join_tightly(edge.label);
  write_graph(out, machine, edges);
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
