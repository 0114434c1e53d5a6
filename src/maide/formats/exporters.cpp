#include "maide/formats/exporters.hpp"

#include <array>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/formats/names.hpp"

namespace maide {
namespace {

constexpr std::array<Exporter, 7> table{{
    {"dot", ".dot", "Graphviz, the format in which models are kept",
     [](std::ostream& out, const Model& model, const ExportOptions&) { write_dot(out, model); }},
    {"mealy", ".dot",
     "a Mealy machine as the Automata Wiki has them, for LearnLib, AALpy and other learners",
     [](std::ostream& out, const Model& model, const ExportOptions&) {
       write_automata_wiki(out, model);
     },
     true},
    {"aut", ".aut", "Aldebaran, read by CADP, mCRL2 and LTSmin",
     [](std::ostream& out, const Model& model, const ExportOptions& options) {
       write_aut(out, model, options.marks);
     }},
    {"promela", ".pml", "Promela, SPIN's language",
     [](std::ostream& out, const Model& model, const ExportOptions&) {
       write_promela(out, model);
     }},
    {"smv", ".smv", "the language of NuSMV and nuXmv",
     [](std::ostream& out, const Model& model, const ExportOptions&) { write_smv(out, model); }},
    {"mcrl2", ".mcrl2", "mCRL2, the process algebra",
     [](std::ostream& out, const Model& model, const ExportOptions&) { write_mcrl2(out, model); }},
    {"cpp", ".hpp", "a C++ class, in one header",
     [](std::ostream& out, const Model& model, const ExportOptions& options) {
       write_cpp(out, model, options.name);
     }},
}};

}  // namespace

std::span<const Exporter> exporters() { return table; }

const Exporter& find_exporter(std::string_view name,
                              std::initializer_list<std::string_view> besides) {
  return find_row(exporters(), "format", name, besides);
}

std::optional<Mealy> completed_machine(const Model& model, std::string_view format) {
  if (const auto* machine = std::get_if<Mealy>(&model)) return *machine;
  const auto* partial = std::get_if<NondeterministicMealy>(&model);
  if (partial == nullptr) return std::nullopt;
  NondeterministicMealy completed = *partial;
  completed.complete_with("refused");
  auto machine = completed.to_mealy();
  if (!machine) {
    throw UsageError("a nondeterministic Mealy machine cannot be exported to " +
                     std::string(format));
  }
  return machine;
}

namespace {

constexpr auto words = std::to_array<std::string_view>(
    {"act",      "allow",    "block",   "comm",     "cons",    "delay",   "delta",    "div",
     "end",      "eqn",      "exists",  "forall",   "glob",    "hide",    "if",       "in",
     "init",     "lambda",   "map",     "mod",      "mu",      "nil",     "nu",       "pbes",
     "proc",     "rename",   "sort",    "struct",   "sum",     "tau",     "true",     "false",
     "val",      "var",      "whr",     "yaled",    "Bag",     "Bool",    "Int",      "List",
     "Nat",      "Pos",      "Real",    "Set",      "FBag",    "FSet",    "abs",      "ceil",
     "count",    "exp",      "floor",   "head",     "max",     "min",     "pred",     "rhead",
     "round",    "rtail",    "succ",    "tail",     "Bag2Set", "Set2Bag", "Int2Nat",  "Int2Pos",
     "Int2Real", "Nat2Int",  "Nat2Pos", "Nat2Real", "Pos2Int", "Pos2Nat", "Pos2Real", "Real2Int",
     "Real2Nat", "Real2Pos", "dist",    "Terminate"});

class Mcrl2Writer {
 public:
  explicit Mcrl2Writer(std::ostream& out) : out_(out), table_(words) {}

  void write(const NondeterministicMealy& machine) {
    const auto inputs = declare(machine.inputs(), "in_"),
               outputs = declare(machine.outputs(), "out_");
    write_head(machine.origin, machine.size());
    for (StateId state = 0; state < machine.size(); ++state) {
      begin(state);
      for (Symbol input = 0; input < inputs.size(); ++input) {
        for (const auto& choice : machine.choices(state, input)) {
          add(inputs[input] + " | " + outputs[choice.output], choice.target);
        }
      }
      end();
    }
    out_ << "init " << states_[machine.initial()] << ";\n";
  }

  void write(const InterfaceAutomaton& automaton) {
    const auto inputs = declare(automaton.inputs(), "in_");
    const auto outputs = declare(automaton.outputs(), "out_");
    const auto untried = declare(automaton.inputs(), "unexplored_");
    write_head(automaton.origin, automaton.size());
    for (StateId state = 0; state < automaton.size(); ++state) {
      begin(state);
      for (const auto& transition : automaton.transitions(state)) {
        const Symbol symbol = transition.action.symbol;
        const auto& names = transition.absorbed            ? untried
                            : transition.action.is_input() ? inputs
                                                           : outputs;
        add(names[symbol], transition.target);
      }
      for (const Symbol input : automaton.unexplored(state)) add(untried[input], state);
      end();
    }
    out_ << "init " << states_[automaton.initial()] << ";\n";
  }

 private:
  std::vector<std::string> declare(const Alphabet& alphabet, const std::string& prefix) {
    auto identifiers = table_.unique(alphabet.names(), prefix);
    for (Symbol symbol = 0; symbol < alphabet.size(); ++symbol) {
      actions_.push_back(identifiers[symbol]);
      if (identifiers[symbol] == prefix + alphabet.name(symbol)) continue;
      remarks_.push_back(identifiers[symbol] + ": " + alphabet.name(symbol));
    }
    return identifiers;
  }

  void write_head(const Origin& origin, std::size_t size) {
    for (const auto& [key, value] : origin) {
      out_ << "% " << comment_text(key) << ": " << comment_text(value) << "\n";
    }
    for (const std::string& remark : remarks_) out_ << "% " << comment_text(remark) << "\n";
    for (const std::string& action : actions_) {
      out_ << (&action == &actions_.front() ? "act " : ", ") << action;
    }
    out_ << (actions_.empty() ? "" : ";\n") << "proc\n";
    for (std::size_t state = 0; state < size; ++state) {
      states_.push_back(table_.unique("S" + std::to_string(state)));
    }
  }

  void begin(StateId state) {
    out_ << "  " << states_[state] << " = ";
    is_first_ = true;
  }
  void add(const std::string& action, StateId target) {
    out_ << (is_first_ ? "" : " + ") << "(" << action << ") . " << states_[target];
    is_first_ = false;
  }
  void end() { out_ << (is_first_ ? "delta" : "") << ";\n"; }

  std::ostream& out_;
  Identifiers table_;
  std::vector<std::string> actions_, remarks_, states_;
  bool is_first_ = true;
};

}  // namespace

std::span<const std::string_view> mcrl2_reserved() { return words; }

void write_mcrl2(std::ostream& out, const Model& model) {
  Mcrl2Writer writer(out);
  if (const auto* machine = std::get_if<Mealy>(&model)) {
    return writer.write(NondeterministicMealy(*machine));
  }
  if (const auto* machine = std::get_if<NondeterministicMealy>(&model)) {
    return writer.write(*machine);
  }
  writer.write(std::get<InterfaceAutomaton>(model));
}

}  // namespace maide
