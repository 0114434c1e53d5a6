// A system as one mCRL2 specification.
#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/engines/export/step_rules.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/formats/exporters.hpp"

namespace maide {
namespace {

class Mcrl2Writer {
 public:
  Mcrl2Writer(std::ostream& out, const System& system)
      : out_(out),
        system_(system),
        rules_(system),
        names_(system, mcrl2_reserved()),
        has_errors_(has_errors(system)) {
    for (const char* own : {"Program", "p", "Running", "Halted", "Nobody"}) names_.of({own});
    for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
      for (ControlState at = 0; at < system.programs[program].states.size(); ++at) {
        for (const StepRule& rule : rules_.rules_of(program, at)) {
          letters_[key_of(rule)].is_cut = rule.is_cut;
        }
      }
    }
    for (const StepRule& rule : rules_.rules_of(nobody, 0)) {
      letters_[key_of(rule)].is_cut = rule.is_cut;
    }
    for (auto& [key, letter] : letters_) name(key, letter);
  }

  void write() {
    out_ << "% " << comment_text(system_.file) << "\n";
    write_declarations();
    for (std::uint32_t model = 0; model < system_.models.size(); ++model) write_model(model);
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      write_program(program);
    }
    if (!system_.nobodys_actions.empty()) write_nobody();
    if (has_errors_) write_halting();
    write_composition();
  }

 private:
  // What programs may do alike: the same action, whatever the program, which is its argument.
  // CombinedStep steps are the program's own.
  struct Key {
    RuleAction action;
    bool is_error = false;  // the program comes to an error
    auto operator<=>(const Key&) const = default;
  };
  // An action, and what its participants do of it. Alone, the program does the action itself.
  struct Letter {
    bool is_cut = false;
    std::string name, of_program, of_halting;
    std::vector<std::string> of_models;  // by relation
    bool is_alone() const { return of_models.empty() && of_halting.empty(); }
  };

  Key key_of(const StepRule& rule) const {
    RuleAction action = rules_.action_of(rule);
    if (action.action.kind != ProgramEdge::Kind::combined) action.action.actor = 0;
    if (rule.actor == nobody) return {std::move(action), false};
    const Program& program = system_.programs[rule.actor];
    return {std::move(action), program.is_error(program.edges[rule.action].target)};
  }

  void name(const Key& key, Letter& letter) {
    const bool is_combined = key.action.action.kind == ProgramEdge::Kind::combined;
    letter.name = rules_.name_of(key.action, names_, is_combined);
    if (key.is_error) letter.name = names_.of({letter.name, "error"});
    const bool is_alone = key.action.relations.empty() && !has_errors_;
    letter.of_program = is_alone ? letter.name : names_.of({"p", letter.name});
    if (has_errors_) letter.of_halting = names_.of({"r", letter.name});
    for (const std::uint32_t number : key.action.relations) {
      const std::string& model = system_.models[rules_.relations()[number].model()].name;
      letter.of_models.push_back(key.action.relations.size() == 1
                                     ? names_.of({"m", letter.name})
                                     : names_.of({"m", model, letter.name}));
    }
  }

  std::string program_value(std::uint32_t actor) {
    return actor == nobody ? names_.of({"nobody"})
                           : names_.of({"prog", system_.programs[actor].name});
  }
  std::string process(std::string_view kind, const std::string& component, std::uint32_t state) {
    return names_.of({kind, component, std::to_string(state)});
  }
  static std::string of_any_program(const std::string& half, const std::string& process) {
    return fmt::format("(sum p: Program . {}(p)) . {}", half, process);
  }

  void write_declarations() {
    std::vector<std::string> values, visible, halves;
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      values.push_back(program_value(program));
    }
    if (!system_.nobodys_actions.empty()) values.push_back(program_value(nobody));
    for (const auto& [key, letter] : letters_) {
      visible.push_back(letter.name);
      if (letter.is_alone()) continue;
      halves.push_back(letter.of_program);
      halves.insert(halves.end(), letter.of_models.begin(), letter.of_models.end());
      if (has_errors_) halves.push_back(letter.of_halting);
    }
    out_ << fmt::format("sort Program = struct {};\n", fmt::join(values, " | "));
    if (!visible.empty()) out_ << fmt::format("act {} : Program;\n", fmt::join(visible, ", "));
    if (!halves.empty()) out_ << fmt::format("    {} : Program;\n", fmt::join(halves, ", "));
    out_ << "proc\n";
  }

  void write_process(const std::string& name, const std::vector<std::string>& summands) {
    out_ << fmt::format("  {} = {};\n", name,
                        summands.empty() ? "delta" : fmt::format("{}", fmt::join(summands, " + ")));
  }

  void write_model(std::uint32_t index) {
    const ModelInstance& model = system_.models[index];
    out_ << fmt::format("  % model {}: {}\n", comment_text(model.name), comment_text(model.origin));
    std::vector<std::vector<std::string>> summands(model.automaton.size());  // by state
    for (const auto& [key, letter] : letters_) {
      for (std::size_t i = 0; i < letter.of_models.size(); ++i) {
        const ModelRelation& relation = rules_.relations()[key.action.relations[i]];
        if (relation.model() != index) continue;
        for (const auto& [from, to] : relation.moves) {
          summands[from].push_back(of_any_program(
              letter.of_models[i], process("Model", model.name, letter.is_cut ? from : to)));
        }
      }
    }
    for (StateId state = 0; state < model.automaton.size(); ++state) {
      write_process(process("Model", model.name, state), summands[state]);
    }
  }

  void write_program(std::uint32_t index) {
    const Program& program = system_.programs[index];
    out_ << fmt::format("  % program {}, line {}\n", comment_text(program.name),
                        program.position.line);
    const std::string value = program_value(index);
    for (ControlState state = 0; state < program.states.size(); ++state) {
      std::vector<std::string> summands;
      for (const StepRule& rule : rules_.rules_of(index, state)) {
        const ControlState target = rule.is_cut ? state : program.edges[rule.action].target;
        summands.push_back(fmt::format("{}({}) . {}", letters_.at(key_of(rule)).of_program, value,
                                       process("Program", program.name, target)));
      }
      write_process(process("Program", program.name, state), summands);
    }
  }

  // One process, which always offers what happens by itself.
  void write_nobody() {
    out_ << "  % what happens by itself\n";
    std::vector<std::string> summands;
    for (const StepRule& rule : rules_.rules_of(nobody, 0)) {
      summands.push_back(fmt::format("{}({}) . Nobody", letters_.at(key_of(rule)).of_program,
                                     program_value(nobody)));
    }
    write_process("Nobody", summands);
  }

  // A participant of every step, until a program comes to an error.
  void write_halting() {
    out_ << "  % nothing follows an error\n";
    std::vector<std::string> summands;
    for (const auto& [key, letter] : letters_) {
      summands.push_back(of_any_program(letter.of_halting, key.is_error ? "Halted" : "Running"));
    }
    write_process("Running", summands);
    write_process("Halted", {});
  }

  void write_composition() {
    std::vector<std::string> visible, meetings, parts;
    for (const auto& [key, letter] : letters_) {
      visible.push_back(letter.name);
      if (letter.is_alone()) continue;
      std::vector<std::string> halves{letter.of_program};
      halves.insert(halves.end(), letter.of_models.begin(), letter.of_models.end());
      if (has_errors_) halves.push_back(letter.of_halting);
      meetings.push_back(fmt::format("{} -> {}", fmt::join(halves, " | "), letter.name));
    }
    for (const ModelInstance& model : system_.models) {
      parts.push_back(process("Model", model.name, model.automaton.initial()));
    }
    for (const Program& program : system_.programs) {
      parts.push_back(process("Program", program.name, 0));
    }
    if (!system_.nobodys_actions.empty()) parts.emplace_back("Nobody");
    if (has_errors_) {
      parts.emplace_back(is_error(system_, initial_state(system_)) ? "Halted" : "Running");
    }
    const std::string parallel = fmt::format("{}", fmt::join(parts, " || "));
    out_ << fmt::format("init allow({{{}}},\n", fmt::join(visible, ", "));
    if (meetings.empty()) {
      out_ << fmt::format("  {});\n", parallel);
    } else {
      out_ << fmt::format("  comm({{{}}},\n    {}));\n", fmt::join(meetings, ", "), parallel);
    }
  }

  std::ostream& out_;
  const System& system_;
  StepRules rules_;
  ExportNames names_;
  bool has_errors_;
  std::map<Key, Letter> letters_;
};

}  // namespace

void write_mcrl2(std::ostream& out, const System& system) { Mcrl2Writer(out, system).write(); }

}  // namespace maide
