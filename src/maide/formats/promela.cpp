// Models as Promela.
#include <ostream>

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
    if (inputs.empty()) out << "  false;\n";
    if (!inputs.empty()) out << "  if\n";
    for (Symbol input = 0; input < inputs.size(); ++input) {
      for (const auto& choice : machine.choices(state, input)) {
        out << "  :: InChannel?" << inputs[input] << " -> OutChannel!" << outputs[choice.output]
            << " -> goto end_s" << choice.target << "\n";
      }
    }
    if (!inputs.empty()) out << "  fi;\n";
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

}  // namespace maide
