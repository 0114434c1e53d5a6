// Models in the languages of model checkers: Promela and SMV.
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/names.hpp"

namespace maide {
namespace {

// An mtype has at most 255 names; larger alphabets are numbers with names.
constexpr std::size_t max_mtype = 255;

class ProctypeWriter {
 public:
  ProctypeWriter(std::ostream& out, const InterfaceAutomaton& automaton,
                 const PromelaProctypeOptions& options)
      : out_(out), automaton_(automaton), options_(options) {}

  void write(const std::string& name) {
    out_ << "proctype " << name << "(chan InChannel; chan OutChannel) {\n";
    if (automaton_.initial() != 0) out_ << "  goto end_s" << automaton_.initial() << ";\n";
    for (StateId state = 0; state < automaton_.size(); ++state) write_state(state);
    if (stops_) out_ << "end_unexplored:  /* never tried */\n  false\n";
    out_ << "}\n";
  }

 private:
  void write_state(StateId state) {
    out_ << "end_s" << state << ":\n";
    has_option_ = false;
    for (const auto& transition : automaton_.transitions(state)) {
      if (!transition.absorbed) write_option(transition.action, state_label(transition.target));
    }
    for (Symbol input = 0; input < automaton_.inputs().size(); ++input) {
      if (!was_never_tried(state, input)) continue;
      const Action action{Action::Kind::input, input};
      if (options_.unexplored == PromelaUnexplored::drop) {
        write_option(action, state_label(state));
      } else if (options_.unexplored == PromelaUnexplored::stop) {
        write_option(action, "end_unexplored");
        stops_ = true;
      }
    }
    out_ << (has_option_ ? "  fi;\n" : "  false;\n");
  }

  static std::string state_label(StateId state) { return "end_s" + std::to_string(state); }

  bool was_never_tried(StateId state, Symbol input) const {
    if (automaton_.is_unexplored(state, input)) return true;
    for (const auto& transition : automaton_.transitions(state)) {
      if (transition.absorbed && transition.action == Action{Action::Kind::input, input}) {
        return true;
      }
    }
    return false;
  }

  // The send is not in atomic { }: a rendezvous passes control on to the receiver, and the goto
  // would become a step of its own.
  void write_option(Action action, const std::string& target) {
    out_ << (has_option_ ? "  :: " : "  if\n  :: ");
    has_option_ = true;
    if (action.is_input()) {
      out_ << "atomic { InChannel?" << options_.inputs[action.symbol] << " -> goto " << target
           << " }\n";
    } else {
      out_ << "OutChannel!" << options_.outputs[action.symbol] << " -> goto " << target << "\n";
    }
  }

  std::ostream& out_;
  const InterfaceAutomaton& automaton_;
  const PromelaProctypeOptions& options_;
  bool has_option_ = false;  // of the state being written
  bool stops_ = false;       // some option leads to end_unexplored
};

// The names of a file's symbols: one identifier for each name, whether input or output.
struct SymbolNames {
  Alphabet all;
  std::vector<std::string> identifiers;

  SymbolNames(const Alphabet& inputs, const Alphabet& outputs, Identifiers& table) {
    for (const std::string& name : inputs.names()) all.intern(name);
    for (const std::string& name : outputs.names()) all.intern(name);
    identifiers = table.unique(all.names());
  }
  std::vector<std::string> of(const Alphabet& alphabet) const {
    std::vector<std::string> list;
    for (const std::string& name : alphabet.names()) list.push_back(identifiers[*all.find(name)]);
    return list;
  }
};

void write_comments(std::ostream& out, const Origin& origin, const SymbolNames& symbols) {
  out << "/* A learned model. To use it in a system of your own, take the process type and "
         "connect\n"
         "   it to your programs by two rendezvous channels. */\n";
  for (const auto& [key, value] : origin) {
    out << "/* " << comment_text(key) << ": " << comment_text(value) << " */\n";
  }
  for (Symbol symbol = 0; symbol < symbols.all.size(); ++symbol) {
    if (symbols.identifiers[symbol] == symbols.all.name(symbol)) continue;
    out << "/* " << symbols.identifiers[symbol] << ": " << comment_text(symbols.all.name(symbol))
        << " */\n";
  }
}

// Declares the symbols; returns the type of messages.
std::string declare_symbols(std::ostream& out, const SymbolNames& symbols) {
  if (symbols.all.size() > max_mtype) {
    for (Symbol symbol = 0; symbol < symbols.all.size(); ++symbol) {
      out << "#define " << symbols.identifiers[symbol] << " " << symbol + 1 << "\n";
    }
    out << "\n";
    return "int";
  }
  if (symbols.all.empty()) return "byte";
  out << "mtype = {";
  const char* separator = " ";
  for (const std::string& identifier : symbols.identifiers) {
    out << separator << identifier;
    separator = ", ";
  }
  out << " };\n\n";
  return "mtype";
}

// Gives every input and takes every output, in any order, for as long as the model lets it.
void write_environment(std::ostream& out, const std::string& type,
                       const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs) {
  out << "\nproctype Environment(chan ToModel; chan FromModel) {\nend:\n";
  if (inputs.empty() && outputs.empty()) {
    out << "  false\n";
  } else {
    out << "  do\n";
    for (const std::string& input : inputs) out << "  :: ToModel!" << input << "\n";
    for (const std::string& output : outputs) out << "  :: FromModel?" << output << "\n";
    out << "  od\n";
  }
  out << "}\n\nchan ToTheModel = [0] of { " << type << " };\nchan FromTheModel = [0] of { " << type
      << " };\n\ninit {\n  atomic {\n    run Model(ToTheModel, FromTheModel);\n"
         "    run Environment(ToTheModel, FromTheModel)\n  }\n}\n";
}

void write_mealy_proctype(std::ostream& out, const NondeterministicMealy& machine,
                          const std::vector<std::string>& inputs,
                          const std::vector<std::string>& outputs) {
  out << "proctype Model(chan InChannel; chan OutChannel) {\n";
  if (machine.initial() != 0) out << "  goto end_s" << machine.initial() << ";\n";
  for (StateId state = 0; state < machine.size(); ++state) {
    out << "end_s" << state << ":\n";
    const bool answers = machine.answers_at(state);
    out << (answers ? "  if\n" : "  false;\n");
    for (Symbol input = 0; input < inputs.size(); ++input) {
      for (const auto& choice : machine.choices(state, input)) {
        out << "  :: InChannel?" << inputs[input] << " -> OutChannel!" << outputs[choice.output]
            << " -> goto end_s" << choice.target << "\n";
      }
    }
    if (answers) out << "  fi;\n";
  }
  out << "}\n";
}

void write_model(std::ostream& out, const NondeterministicMealy& machine,
                 const SymbolNames& symbols) {
  write_mealy_proctype(out, machine, symbols.of(machine.inputs()), symbols.of(machine.outputs()));
}

void write_model(std::ostream& out, const Mealy& machine, const SymbolNames& symbols) {
  write_model(out, NondeterministicMealy(machine), symbols);
}

void write_model(std::ostream& out, const InterfaceAutomaton& automaton,
                 const SymbolNames& symbols) {
  PromelaProctypeOptions options;
  options.inputs = symbols.of(automaton.inputs());
  options.outputs = symbols.of(automaton.outputs());
  write_promela_proctype(out, automaton, "Model", options);
}

}  // namespace

void write_promela_proctype(std::ostream& out, const InterfaceAutomaton& automaton,
                            const std::string& name, const PromelaProctypeOptions& options) {
  ProctypeWriter(out, automaton, options).write(name);
}

void write_promela(std::ostream& out, const Model& model) {
  std::visit(
      [&](const auto& automaton) {
        Identifiers table(promela_reserved());
        for (const char* own : {"Model", "Environment", "InChannel", "OutChannel", "ToModel",
                                "FromModel", "ToTheModel", "FromTheModel"}) {
          table.unique(own);
        }
        table.unique("end_unexplored");  // labels: spin would read them as the names
        for (StateId state = 0; state < automaton.size(); ++state) {
          table.unique("end_s" + std::to_string(state));
        }
        const SymbolNames symbols(automaton.inputs(), automaton.outputs(), table);
        write_comments(out, automaton.origin, symbols);
        const std::string type = declare_symbols(out, symbols);
        write_model(out, automaton, symbols);
        write_environment(out, type, symbols.of(automaton.inputs()),
                          symbols.of(automaton.outputs()));
      },
      model);
}

// Models as SMV modules.

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
  if (const auto machine = completed_machine(model, "SMV")) return writer.write(*machine);
  writer.write(std::get<InterfaceAutomaton>(model));
}

}  // namespace maide
