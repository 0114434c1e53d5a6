// Models as SMV modules.
#include <ostream>

#include "maide/base/error.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/names.hpp"

namespace maide {

namespace {

void write_list(std::ostream& out, const std::vector<std::string>& names) {
  out << "{";
  for (const std::string& name : names) out << (&name == &names.front() ? "" : ", ") << name;
  out << "}";
}

class SmvWriter {
 public:
  explicit SmvWriter(std::ostream& out) : out_(out), table_(smv_reserved()) {
    for (const char* own : {"state", "input", "output", "action", "idle", "quiescent"}) {
      table_.unique(own);
    }
  }

  void write(const Mealy& machine) {
    if (machine.inputs().empty()) {
      throw UsageError("a Mealy machine without inputs cannot be exported to SMV");
    }
    const auto inputs = declare(machine.inputs(), "in_");
    const auto outputs = declare(machine.outputs(), "out_");
    write_head(machine.origin, "A learned Mealy machine.");
    out_ << "IVAR\n  input : ";
    write_list(out_, inputs);
    out_ << ";\n";
    write_state_variable(machine.size());
    if (!outputs.empty()) {
      out_ << "CONSTANTS\n  ";
      for (const std::string& output : outputs) {
        out_ << (&output == &outputs.front() ? "" : ", ") << output;
      }
      out_ << ";\n";
    }
    out_ << "DEFINE\n";
    write_cases("output :=", machine, inputs,
                [&](StateId state, Symbol input) { return outputs[machine.output(state, input)]; });
    out_ << "ASSIGN\n  init(state) := s" << machine.initial() << ";\n";
    write_cases("next(state) :=", machine, inputs, [&](StateId state, Symbol input) {
      return "s" + std::to_string(machine.target(state, input));
    });
  }

  void write(const InterfaceAutomaton& automaton) {
    const auto inputs = declare(automaton.inputs(), "in_");
    const auto outputs = declare(automaton.outputs(), "out_");
    std::vector<std::string> actions{"idle"};
    actions.insert(actions.end(), inputs.begin(), inputs.end());
    actions.insert(actions.end(), outputs.begin(), outputs.end());
    write_head(automaton.origin, "A learned interface automaton.");
    out_ << "IVAR\n  action : ";
    write_list(out_, actions);
    out_ << ";\n";
    write_state_variable(automaton.size());
    write_defines(automaton);
    out_ << "INIT\n  state = s" << automaton.initial()
         << ";\nTRANS\n  (quiescent & action = idle & next(state) = state)";
    for (StateId state = 0; state < automaton.size(); ++state) {
      for (const auto& transition : automaton.transitions(state)) {
        if (transition.absorbed) continue;
        const auto& names = transition.action.is_input() ? inputs : outputs;
        out_ << "\n  | (state = s" << state << " & action = " << names[transition.action.symbol]
             << " & next(state) = s" << transition.target << ")";
      }
    }
    out_ << ";\n";
  }

 private:
  std::vector<std::string> declare(const Alphabet& alphabet, const char* prefix) {
    auto identifiers = table_.unique(alphabet.names(), prefix);
    for (Symbol symbol = 0; symbol < alphabet.size(); ++symbol) {
      if (identifiers[symbol] != prefix + alphabet.name(symbol)) {
        remarks_.push_back(identifiers[symbol] + ": " + alphabet.name(symbol));
      }
    }
    return identifiers;
  }

  void write_head(const Origin& origin, const char* what) {
    out_ << "-- " << what << "\n";
    for (const auto& [key, value] : origin) {
      out_ << "-- " << comment_text(key) << ": " << comment_text(value) << "\n";
    }
    for (const std::string& remark : remarks_) out_ << "-- " << comment_text(remark) << "\n";
    out_ << "MODULE main\n";
  }

  // States are s0, s1, ...: no symbol can be called so, for they have prefixes.
  void write_state_variable(std::size_t size) {
    std::vector<std::string> states;
    for (std::size_t state = 0; state < size; ++state)
      states.push_back("s" + std::to_string(state));
    out_ << "VAR\n  state : ";
    write_list(out_, states);
    out_ << ";\n";
  }

  // Nested cases, the last of each TRUE, so that they are exhaustive for whoever reads them.
  template <typename Value>
  void write_cases(const char* head, const Mealy& machine, const std::vector<std::string>& inputs,
                   Value value) {
    out_ << "  " << head << "\n    case\n";
    for (StateId state = 0; state < machine.size(); ++state) {
      out_ << "      ";
      if (state + 1 < machine.size()) {
        out_ << "state = s" << state << " : ";
      } else {
        out_ << "TRUE : ";
      }
      out_ << "case ";
      for (Symbol input = 0; input < inputs.size(); ++input) {
        if (input + 1 < inputs.size()) {
          out_ << "input = " << inputs[input] << " : ";
        } else {
          out_ << "TRUE : ";
        }
        out_ << value(state, input) << "; ";
      }
      out_ << "esac;\n";
    }
    out_ << "    esac;\n";
  }

  void write_defines(const InterfaceAutomaton& automaton) {
    std::vector<std::string> quiescent;
    for (StateId state = 0; state < automaton.size(); ++state) {
      if (automaton.is_quiescent(state)) quiescent.push_back("s" + std::to_string(state));
    }
    out_ << "DEFINE\n";
    write_define("quiescent", quiescent);
    for (Symbol input = 0; input < automaton.inputs().size(); ++input) {
      std::vector<std::string> possible, unexplored;
      for (StateId state = 0; state < automaton.size(); ++state) {
        const std::string name = "s" + std::to_string(state);
        bool is_possible = false;
        bool is_unexplored = automaton.is_unexplored(state, input);
        for (const auto& transition : automaton.transitions(state)) {
          if (transition.action != Action{Action::Kind::input, input}) continue;
          (transition.absorbed ? is_unexplored : is_possible) = true;
        }
        if (is_possible) possible.push_back(name);
        if (is_unexplored) unexplored.push_back(name);
      }
      const std::string& name = automaton.inputs().name(input);
      write_define(table_.unique("can_" + name), possible);
      write_define(table_.unique("unexplored_" + name), unexplored);
    }
  }
  void write_define(const std::string& name, const std::vector<std::string>& states) {
    out_ << "  " << name << " := ";
    if (states.empty()) {
      out_ << "FALSE";
    } else {
      out_ << "state in ";
      write_list(out_, states);
    }
    out_ << ";\n";
  }

  std::ostream& out_;
  Identifiers table_;
  std::vector<std::string> remarks_;  // identifiers that differ from their names
};

}  // namespace

void write_smv(std::ostream& out, const Model& model) {
  SmvWriter writer(out);
  if (std::holds_alternative<NondeterministicMealy>(model)) {
    throw UsageError("a nondeterministic Mealy machine cannot be exported to SMV");
  }
  if (const auto* machine = std::get_if<Mealy>(&model)) return writer.write(*machine);
  writer.write(std::get<InterfaceAutomaton>(model));
}

}  // namespace maide
