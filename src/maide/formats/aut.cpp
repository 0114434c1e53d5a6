// Models in the format .aut: reading and writing.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/formats/names.hpp"

namespace maide {

namespace {

// Beyond what the transitions touch: isolated states are legal, a file of 20 bytes that asks for
// gigabytes of them is not.
constexpr std::uint64_t max_isolated_states = 1'000'000;

class AutReader {
 public:
  AutReader(std::string_view text, const std::string& file, const ModelReading& reading)
      : cursor_(without_byte_order_mark(text), file, TextCursor::Columns::bytes),
        reading_(reading) {
    graph_.file = file;
  }

  Model read() {
    expect("des");
    expect("(");
    const auto initial_place = here();
    const std::uint64_t initial = number("the initial state");
    expect(",");
    const auto count_place = here();
    const std::uint64_t transitions = number("the number of transitions");
    expect(",");
    const auto states_place = here();
    states_ = number("the number of states");
    expect(")");
    if (states_ == 0) fail("a model has at least one state", states_place);
    if (initial >= states_)
      fail("the initial state is not below the number of states", initial_place);
    for (here(); !cursor_.at_end(); here()) transition();
    if (graph_.edges.size() != transitions) {
      fail("the first line says " + std::to_string(transitions) + " transitions, there are " +
               std::to_string(graph_.edges.size()),
           count_place);
    }
    if (states_ > 2 * transitions + max_isolated_states) {
      fail("the first line says " + std::to_string(states_) +
               " states, most of them without transitions",
           states_place);
    }
    graph_.initial = static_cast<StateId>(initial);
    graph_.states.reserve(states_);
    for (std::uint64_t state = 0; state < states_; ++state) {
      graph_.states.push_back({std::to_string(state), states_place, {}});
    }
    set_initial(reading_, graph_);
    note_labels(reading_, graph_);
    return to_model(graph_);
  }

 private:
  // Behind the blanks.
  TextPlace here() {
    cursor_.skip_blanks();
    return cursor_.place();
  }
  [[noreturn]] void fail(const std::string& what, TextPlace place) const {
    cursor_.fail(what, place);
  }
  void expect(const std::string& word) {
    const TextPlace place = here();
    if (!cursor_.accept(word)) fail("'" + word + "' expected", place);
  }

  std::uint64_t number(const std::string& what) {
    const TextPlace place = here();
    const std::string_view rest = cursor_.rest();
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error == std::errc::invalid_argument) fail(what + " expected", place);
    if (error != std::errc{} || value >= Mealy::no_state) fail(what + " is too large", place);
    cursor_.take(static_cast<std::size_t>(end - rest.data()));
    return value;
  }

  StateId state() {
    const TextPlace place = here();
    const std::uint64_t value = number("a state");
    if (value >= states_) {
      fail("state " + std::to_string(value) + " is not below the number of states", place);
    }
    return static_cast<StateId>(value);
  }

  void transition() {
    expect("(");
    LabelledGraph::Edge edge;
    edge.from = state();
    expect(",");
    edge.place = here();
    edge.label = label();
    expect(",");
    edge.to = state();
    expect(")");
    graph_.edges.push_back(std::move(edge));
  }

  // Whether a target and the end of a transition are next.
  static bool is_before_target(std::string_view rest) {
    const auto skip = [&](auto&& belongs) {
      const auto end = std::ranges::find_if_not(rest, belongs);
      const auto count = static_cast<std::size_t>(end - rest.begin());
      rest.remove_prefix(count);
      return count;
    };
    skip(is_space);
    if (!rest.starts_with(',')) return false;
    rest.remove_prefix(1);
    skip(is_space);
    if (skip(is_digit) == 0) return false;
    skip(is_space);
    return rest.starts_with(')');
  }

  // Whether the label ends with the quote before this: what is next, or no later quote on the line
  // is one with which it could end.
  bool is_closing() const {
    std::string_view line = cursor_.rest();
    line = line.substr(0, line.find('\n'));
    if (is_before_target(line)) return true;
    for (std::size_t i = line.find('"'); i != std::string_view::npos; i = line.find('"', i + 1)) {
      if (is_before_target(line.substr(i + 1))) return false;
    }
    return true;
  }

  // In quotes (\" and \\ inside, as write_aut writes them; others leave quotes inside as they
  // are), or else up to the line's last comma.
  std::string label() {
    std::string text;
    const TextPlace begin = cursor_.place();
    if (cursor_.accept("\"")) {
      while (!cursor_.at_end() && cursor_.peek() != '\n') {
        char letter = cursor_.take();
        if (letter == '"' && is_closing()) return text;
        if (letter == '\\' && !cursor_.at_end()) {
          letter = cursor_.take();
          if (letter == 'n') letter = '\n';
        }
        text += letter;
      }
      fail("unfinished label", begin);
    }
    const std::string_view rest = cursor_.rest();
    const std::size_t comma = rest.substr(0, rest.find('\n')).rfind(',');
    if (comma == std::string_view::npos) fail("',' expected after the label", begin);
    return std::string(trim(cursor_.take(comma)));
  }

  TextCursor cursor_;
  const ModelReading& reading_;
  LabelledGraph graph_;
  std::uint64_t states_ = 0;
};

void write_line(std::ostream& out, StateId from, std::string_view label, StateId to) {
  out << '(' << from << ", \"";
  for (const char letter : label) {
    if (letter == '\n') {
      out << "\\n";
      continue;
    }
    if (letter == '"' || letter == '\\') out << '\\';
    out << letter;
  }
  out << "\", " << to << ")\n";
}

// There is no place to say what the labels are: a machine all of whose inputs begin with ? or !
// would come back as an interface automaton.
void refuse_misleading_labels(const Alphabet& inputs) {
  std::vector<std::string> labels;
  for (const std::string& input : inputs.names()) {
    labels.push_back(mealy_label(input, "output"));
  }
  if (looks_like_interface_automaton({labels.begin(), labels.end()})) {
    throw UsageError(
        "the .aut format cannot carry a Mealy machine whose inputs all begin with "
        "'?' or '!'");
  }
}

void write_transitions(std::ostream& out, const NondeterministicMealy& machine) {
  out << "des (" << machine.initial() << ", " << machine.transition_count() << ", "
      << machine.size() << ")\n";
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const auto& choice : machine.choices(state, input)) {
        write_line(out, state,
                   mealy_label(machine.inputs().name(input), machine.outputs().name(choice.output)),
                   choice.target);
      }
    }
  }
}

void write_transitions(std::ostream& out, const Mealy& machine) {
  write_transitions(out, NondeterministicMealy(machine));
}

void write_transitions(std::ostream& out, const InterfaceAutomaton& automaton) {
  out << "des (" << automaton.initial() << ", " << automaton.transition_count() << ", "
      << automaton.size() << ")\n";
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      write_line(out, state, action_label(automaton, transition.action), transition.target);
    }
  }
}

}  // namespace

Model read_aut(std::string_view text, const std::string& file, const ModelReading& reading) {
  return AutReader(text, file, reading).read();
}

std::string marks_of(const Model& model) {
  if (const auto* machine = std::get_if<Mealy>(&model)) {
    return find_initial_output(*machine) ? "first output, that of a Moore machine" : "";
  }
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr) return "";
  bool unexplored = false;
  bool absorbed = false;
  for (StateId state = 0; state < automaton->size(); ++state) {
    unexplored |= !automaton->unexplored(state).empty();
    for (const auto& transition : automaton->transitions(state)) absorbed |= transition.absorbed;
  }
  std::string marks;
  const auto add = [&](bool there, const char* what) {
    if (there) marks += (marks.empty() ? "" : ", ") + std::string(what);
  };
  add(unexplored, "unexplored inputs");
  add(absorbed, "absorbed edges");
  add(!automaton->hidden_returns.empty(), "hidden returns");
  return marks;
}

void write_aut(std::ostream& out, const Model& model, MarkLoss marks) {
  const std::string lost = marks_of(model);
  if (marks == MarkLoss::refuse && !lost.empty()) {
    throw UsageError("the .aut format cannot carry the model's " + lost +
                     ": --lossy writes it without");
  }
  if (!std::holds_alternative<InterfaceAutomaton>(model)) {
    std::visit([](const auto& machine) { refuse_misleading_labels(machine.inputs()); }, model);
  }
  std::visit([&](const auto& automaton) { write_transitions(out, automaton); }, model);
}

}  // namespace maide
