// Models as C++ headers.
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/names.hpp"

namespace maide {

namespace {

// A C++ string literal. Octal escapes end after three digits, whatever follows.
std::string literal(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\' || letter == '?') {  // '?': no trigraphs
      result += '\\';
      result += letter;
    } else if (code >= 0x20 && code < 0x7f) {
      result += letter;
    } else {
      result += '\\';
      for (const int shift : {6, 3, 0}) {
        result += static_cast<char>('0' + ((code >> static_cast<unsigned>(shift)) & 7U));
      }
    }
  }
  return result + '"';
}

class CppWriter {
 public:
  CppWriter(std::ostream& out, const std::string& class_name) : out_(out) {
    Identifiers table(cpp_reserved());
    for (const char* own : {"State", "Input", "Output", "Answer"}) table.unique(own);
    name_ = table.unique(class_name);
  }

  void write(const Mealy& machine) {
    write_head(machine.origin, "A learned Mealy machine.");
    write_enums(machine.size(), machine.inputs(), machine.outputs());
    out_ << R"(
  void reset() { state_ = initial; }
  State state() const { return state_; }
  // Takes the input's transition and returns its output.
  Output step(Input input) {
    const Step& step = steps[static_cast<std::size_t>(state_)][static_cast<std::size_t>(input)];
    state_ = static_cast<State>(step.target);
    return static_cast<Output>(step.output);
  }

 private:
  struct Step {
    unsigned long target;
    unsigned long output;
  };
)";
    write_initial(machine.initial());
    const std::size_t width = machine.inputs().size();
    write_table("Step", "steps", machine.size(), width, [&](StateId state, std::size_t input) {
      const auto symbol = static_cast<Symbol>(input);
      out_ << "{" << machine.target(state, symbol) << ", " << machine.output(state, symbol) << "}";
    });
    out_ << "  State state_ = initial;\n};\n";
  }

  void write(const InterfaceAutomaton& automaton) {
    if (!automaton.is_deterministic()) {
      throw UsageError("a nondeterministic interface automaton cannot be exported to C++");
    }
    write_head(automaton.origin, "A learned interface automaton.");
    write_enums(automaton.size(), automaton.inputs(), automaton.outputs());
    out_ << R"(
  // What the model says of an input in the present state.
  enum class Answer {
    accepted,     // it is possible
    refused,      // the system does not take it here: it would wait
    never_tried,  // learning did not go that far: nothing is known
  };

  void reset() { state_ = initial; }
  State state() const { return state_; }

  Answer try_input(Input input) const {
    const long target = input_target(input);
    return target >= 0 ? Answer::accepted : target == -1 ? Answer::refused : Answer::never_tried;
  }
  bool can(Input input) const { return input_target(input) >= 0; }
  // Gives the input; false, and no change, if it is refused or was never tried.
  bool input(Input input) { return move(input_target(input)); }

  // The system may emit this output now.
  bool is_due(Output output) const { return output_target(output) >= 0; }
  // Takes the output; false, and no change, if it is not due.
  bool take(Output output) { return move(output_target(output)); }
  // No output is due: the system waits for an input.
  bool is_quiescent() const {
    for (const long target : output_targets[static_cast<std::size_t>(state_)]) {
      if (target >= 0) return false;
    }
    return true;
  }

 private:
  long input_target(Input input) const {
    return input_targets[static_cast<std::size_t>(state_)][static_cast<std::size_t>(input)];
  }
  long output_target(Output output) const {
    return output_targets[static_cast<std::size_t>(state_)][static_cast<std::size_t>(output)];
  }
  bool move(long target) {
    if (target < 0) return false;
    state_ = static_cast<State>(target);
    return true;
  }

)";
    write_initial(automaton.initial());
    out_ << "  // The next state; -1: refused, -2: never tried.\n";
    write_targets(automaton, Action::Kind::input, automaton.inputs().size(), "input_targets");
    write_targets(automaton, Action::Kind::output, automaton.outputs().size(), "output_targets");
    out_ << "  State state_ = initial;\n};\n";
  }

 private:
  void write_head(const Origin& origin, const char* what) {
    out_ << "// " << what << "\n";
    for (const auto& [key, value] : origin) {
      out_ << "// " << comment_text(key) << ": " << comment_text(value) << "\n";
    }
    out_ << "#pragma once\n\n#include <array>\n#include <cstddef>\n\nclass " << name_
         << " {\n public:\n";
  }

  void write_enums(std::size_t states, const Alphabet& inputs, const Alphabet& outputs) {
    out_ << "  enum class State : unsigned long {";
    for (std::size_t state = 0; state < states; ++state) {
      out_ << (state == 0 ? "" : ",") << (state % 12 == 0 ? "\n    s" : " s") << state;
    }
    out_ << "\n  };\n";
    write_enum("Input", inputs);
    write_enum("Output", outputs);
    write_names("Input", "input_names", inputs);
    write_names("Output", "output_names", outputs);
  }

  void write_enum(const char* type, const Alphabet& alphabet) {
    Identifiers table(cpp_reserved());
    out_ << "  enum class " << type << " : unsigned long {\n";
    for (const std::string& identifier : table.unique(alphabet.names())) {
      out_ << "    " << identifier << ",\n";
    }
    out_ << "  };\n";
  }

  void write_names(const char* type, const char* table, const Alphabet& alphabet) {
    out_ << "  // The names as the model has them, in the order of " << type << ".\n"
         << "  static constexpr std::array<const char*, " << alphabet.size() << "> " << table
         << "{";
    const char* separator = "";
    for (const std::string& name : alphabet.names()) {
      out_ << separator << literal(name);
      separator = ", ";
    }
    out_ << "};\n";
  }

  void write_initial(StateId initial) {
    out_ << "  static constexpr State initial = State::s" << initial << ";\n";
  }

  void write_table(const char* type, const char* name, std::size_t rows, std::size_t width,
                   const std::function<void(StateId, std::size_t)>& write_cell) {
    out_ << "  static constexpr std::array<std::array<" << type << ", " << width << ">, " << rows
         << "> " << name << "{{\n";
    for (StateId row = 0; row < rows; ++row) {
      out_ << "    {";
      // One pair of braces for the array, one for what it holds; an empty array wants none.
      if (width > 0) out_ << "{";
      for (std::size_t column = 0; column < width; ++column) {
        if (column > 0) out_ << ", ";
        write_cell(row, column);
      }
      out_ << (width > 0 ? "}},\n" : "},\n");
    }
    out_ << "  }};\n";
  }

  void write_targets(const InterfaceAutomaton& automaton, Action::Kind kind, std::size_t width,
                     const char* name) {
    write_table("long", name, automaton.size(), width, [&](StateId state, std::size_t column) {
      const Action action{kind, static_cast<Symbol>(column)};
      long target = -1;
      if (kind == Action::Kind::input && automaton.is_unexplored(state, action.symbol)) target = -2;
      for (const auto& transition : automaton.transitions(state)) {
        if (transition.action != action) continue;
        target = transition.absorbed ? -2 : static_cast<long>(transition.target);
      }
      out_ << target;
    });
  }

  std::ostream& out_;
  std::string name_;
};

}  // namespace

void write_cpp(std::ostream& out, const Model& model, const std::string& class_name) {
  CppWriter writer(out, class_name);
  if (const auto machine = completed_machine(model, "C++")) return writer.write(*machine);
  writer.write(std::get<InterfaceAutomaton>(model));
}

}  // namespace maide
