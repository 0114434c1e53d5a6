// The idea: a model's module constrains its next state by the step's action, and defines where it
// can be used how; a program's module does the same with its control states; main lets a step
// happen only where all sides can.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/check/engines/export/step_rules.hpp"
#include "maide/check/engines/export/system_exporters.hpp"

namespace maide {
namespace {

// `variable in {0, 3}`, or FALSE.
std::string membership(std::string_view variable, const std::vector<std::uint32_t>& values) {
  if (values.empty()) return "FALSE";
  return fmt::format("{} in {{{}}}", variable, fmt::join(values, ", "));
}

// From where to where a model, or a program's control, goes.
using Moves = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::string moved(std::string_view variable, const Moves& moves) {
  std::string text;
  for (const auto& [from, to] : moves) {
    text += fmt::format("{}({} = {} & next({}) = {})", text.empty() ? "" : "\n        | ", variable,
                        from, variable, to);
  }
  return text.empty() ? "FALSE" : text;
}

std::vector<std::uint32_t> sources(const Moves& moves) {
  std::set<std::uint32_t> result;
  for (const auto& move : moves) result.insert(move.first);
  return {result.begin(), result.end()};
}

class SmvWriter {
 public:
  SmvWriter(std::ostream& out, const System& system)
      : out_(out),
        system_(system),
        rules_(system),
        names_(system, smv_reserved()),
        has_errors_(has_errors(system)) {
    for (const char* own : {"step", "idle", "state", "control", "ended", "rests", "is_error",
                            "all_ended", "can_step", "can_go_on", "deadlock"}) {
      names_.of({own});
    }
    for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
      for (ControlState at = 0; at < system.programs[program].states.size(); ++at) {
        for (const StepRule& rule : rules_.rules_of(program, at)) add(rule);
      }
    }
    for (const StepRule& rule : rules_.rules_of(nobody, 0)) add(rule);
    for (const auto& [action, letter] : letters_) step_name(action);
    for (std::uint32_t number = 0; number < rules_.relations().size(); ++number) {
      relations_.push_back(number);
    }
    const auto key = [&](std::uint32_t number) {
      const ModelRelation& relation = rules_.relations()[number];
      return std::tuple(relation.use.kind, relation.use.index, relation.bound);
    };
    std::ranges::sort(
        relations_, [&](std::uint32_t one, std::uint32_t other) { return key(one) < key(other); });
  }

  void write() {
    out_ << "-- " << comment_text(system_.file) << "\n";
    for (const auto& [action, letter] : letters_) {
      out_ << fmt::format("-- {}: {}\n", step_name(action), comment_text(names_.of(action.action)));
    }
    write_main();
    for (std::uint32_t model = 0; model < system_.models.size(); ++model) write_model(model);
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      write_program(program);
    }
  }

 private:
  // What the actor does in the steps of one action.
  struct Letter {
    bool is_cut = false;
    bool is_progress = true;
    Moves moves;  // of its control; of nobody none
  };

  void add(const StepRule& rule) {
    const Step step = StepRules::begun_step(rule);
    Letter& letter = letters_[rules_.action_of(rule)];
    letter.is_cut = rule.is_cut;
    letter.is_progress = is_progress(system_, step);
    if (rule.actor == nobody) return;
    const ProgramEdge& edge = edge_of(system_, step);
    letter.moves.emplace_back(rule.source, edge.target);
  }

  const std::string& step_name(const RuleAction& action) {
    return rules_.name_of(action, names_, true);
  }
  const std::string& instance(std::string_view kind, const std::string& name) {
    return names_.of({kind, name});
  }
  // A definition of a program's module: where its text has the action. It knows nothing of what its
  // models were learned for.
  std::string can(StepAction action) {
    action.is_beyond = false;
    return names_.of({"can", names_.of(action, system_, false)});
  }
  // A definition of a model's module: where the relation has a move.
  std::string can(const ModelRelation& relation) {
    const StepAction action{0, relation.use.kind, relation.use.model, relation.use.index,
                            relation.bound != ModelRelation::Bound::within};
    return names_.of({"can", names_.of(action, system_, false)});
  }
  std::string main_can(const RuleAction& action) { return names_.of({"can", step_name(action)}); }
  std::string all_can(const RuleAction& action) {
    std::string text = "TRUE";
    if (action.action.actor != nobody) {
      text = instance("p", system_.programs[action.action.actor].name) + "." + can(action.action);
    }
    for (const std::uint32_t number : action.relations) {
      const ModelRelation& relation = rules_.relations()[number];
      text += " & " + instance("m", system_.models[relation.model()].name) + "." + can(relation);
    }
    return has_errors_ ? text + " & !is_error" : text;
  }

  void write_main() {
    out_ << "MODULE main\nIVAR\n  step : {idle";
    for (const auto& [action, letter] : letters_) out_ << ", " << step_name(action);
    out_ << "};\nVAR\n";
    for (const ModelInstance& model : system_.models) {
      out_ << fmt::format("  {} : {}(step);\n", instance("m", model.name),
                          instance("model", model.name));
    }
    for (const Program& program : system_.programs) {
      out_ << fmt::format("  {} : {}(step);\n", instance("p", program.name),
                          instance("program", program.name));
    }
    out_ << "DEFINE\n";
    if (has_errors_) {
      out_ << "  is_error := ";
      for (const Program& program : system_.programs) {
        out_ << instance("p", program.name) << ".is_error | ";
      }
      out_ << "FALSE;\n";
    }
    bool has_idle_steps = false;
    for (const auto& [action, letter] : letters_) {
      out_ << fmt::format("  {} := {};\n", main_can(action), all_can(action));
      has_idle_steps = has_idle_steps || !letter.is_progress;
    }
    out_ << "  can_step := ";
    for (const auto& [action, letter] : letters_) out_ << main_can(action) << " | ";
    out_ << "FALSE;\n";
    if (has_idle_steps) {
      out_ << "  can_go_on := ";  // but for deaths
      for (const auto& [action, letter] : letters_) {
        if (letter.is_progress) out_ << main_can(action) << " | ";
      }
      out_ << "FALSE;\n";
    }
    out_ << "  all_ended := ";
    for (const Program& program : system_.programs) {
      const std::string& name = instance("p", program.name);
      out_ << (may_rest(program) ? fmt::format("({0}.ended | {0}.rests) & ", name)
                                 : name + ".ended & ");
    }
    out_ << fmt::format("TRUE;\n  deadlock := !{} & !all_ended{};\nTRANS\n  case\n",
                        has_idle_steps ? "can_go_on" : "can_step",
                        has_errors_ ? " & !is_error" : "");
    for (const auto& [action, letter] : letters_) {
      out_ << fmt::format("    step = {} : {};\n", step_name(action), main_can(action));
    }
    out_ << "    TRUE : !can_step;\n  esac;\nINVARSPEC !deadlock;\n";
    if (has_errors_) out_ << "INVARSPEC !is_error;\n";
  }

  static bool may_rest(const Program& program) {
    return std::ranges::any_of(program.states, [&](const Program::State& state) {
      return program.flags.may_rest || state.may_rest;
    });
  }

  void write_model(std::uint32_t index) {
    const ModelInstance& model = system_.models[index];
    out_ << fmt::format(
        "\n-- model {}: {}\nMODULE {}(step)\nVAR\n  state : 0..{};\nASSIGN\n  init(state) := {};\n",
        comment_text(model.name), comment_text(model.origin), instance("model", model.name),
        model.automaton.size() - 1, model.automaton.initial());
    std::string definitions, cases;
    for (const std::uint32_t number : relations_) {
      const ModelRelation& relation = rules_.relations()[number];
      if (relation.model() != index) continue;
      definitions +=
          fmt::format("  {} := {};\n", can(relation), membership("state", sources(relation.moves)));
      if (relation.changes_nothing()) continue;
      std::vector<std::string> steps;
      for (const auto& [action, letter] : letters_) {
        const bool has_part = std::ranges::find(action.relations, number) != action.relations.end();
        if (has_part && !letter.is_cut) steps.push_back(step_name(action));
      }
      if (steps.empty()) continue;
      cases += fmt::format("    step in {{{}}} :\n        {};\n", fmt::join(steps, ", "),
                           moved("state", relation.moves));
    }
    if (!definitions.empty()) out_ << "DEFINE\n" << definitions;
    out_ << "TRANS\n  case\n" << cases << "    TRUE : next(state) = state;\n  esac;\n";
  }

  void write_program(std::uint32_t index) {
    const Program& program = system_.programs[index];
    out_ << fmt::format(
        "\n-- program {}, line {}\nMODULE {}(step)\nVAR\n  control : 0..{};\nASSIGN\n"
        "  init(control) := 0;\nDEFINE\n",
        comment_text(program.name), program.position.line, instance("program", program.name),
        program.states.size() - 1);
    write_control_definitions(program);
    std::map<std::string, Moves> moves;
    for (const auto& [action, letter] : letters_) {
      if (action.action.actor != index) continue;
      Moves& all = moves[can(action.action)];
      all.insert(all.end(), letter.moves.begin(), letter.moves.end());
    }
    for (const auto& [name, from_to] : moves) {
      out_ << fmt::format("  {} := {};\n", name, membership("control", sources(from_to)));
    }
    out_ << "TRANS\n  case\n";
    for (const auto& [action, letter] : letters_) {
      if (action.action.actor != index || letter.is_cut) continue;
      out_ << fmt::format("    step = {} :\n        {};\n", step_name(action),
                          moved("control", letter.moves));
    }
    out_ << "    TRUE : next(control) = control;\n  esac;\n";
  }

  void write_control_definitions(const Program& program) {
    const auto define = [&](const std::string& name, const auto& holds) {
      std::vector<std::uint32_t> states;
      for (ControlState state = 0; state < program.states.size(); ++state) {
        if (holds(state)) states.push_back(state);
      }
      out_ << fmt::format("  {} := {};\n", name, membership("control", states));
    };
    define("ended", [&](ControlState state) { return program.is_end(state); });
    if (may_rest(program)) {
      define("rests", [&](ControlState state) { return program.may_rest(state); });
    }
    if (has_errors_) {
      define("is_error", [&](ControlState state) { return program.is_error(state); });
    }
    for (std::uint32_t label = 0; label < program.labels.size(); ++label) {
      define(names_.of({"at", program.labels[label]}),
             [&](ControlState state) { return program.has_label(state, label); });
    }
  }

  std::ostream& out_;
  const System& system_;
  StepRules rules_;
  ExportNames names_;
  std::map<RuleAction, Letter> letters_;
  std::vector<std::uint32_t> relations_;  // by kind, symbol and bound
  bool has_errors_;
};

}  // namespace

void write_smv(std::ostream& out, const System& system) { SmvWriter(out, system).write(); }

}  // namespace maide
