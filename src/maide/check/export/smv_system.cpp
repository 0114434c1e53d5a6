// The idea: a model's module constrains its next state by the step's action, and defines where it
// takes or gives what; a program's module does the same with its control states; main lets a step
// happen only where both sides can.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/check/explore/step_action.hpp"
#include "maide/check/export/system_exporters.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

// `variable in {0, 3}`, or FALSE.
std::string membership(std::string_view variable, const std::vector<std::uint32_t>& values) {
  if (values.empty()) return "FALSE";
  return fmt::format("{} in {{{}}}", variable, fmt::join(values, ", "));
}

// What a model does at its end of an action: where, and what comes of it.
using Moves = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::string relation(std::string_view variable, const Moves& moves) {
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

class Writer {
 public:
  Writer(std::ostream& out, const System& system)
      : out_(out), system_(system), names_(smv_reserved()), actions_(step_actions(system)) {
    for (const char* own :
         {"step", "idle", "state", "control", "ended", "all_ended", "can_step", "deadlock"}) {
      names_.of({own});
    }
    for (const StepAction& action : actions_) step_name(action);
  }

  void write() {
    out_ << "-- " << comment_text(system_.file) << "\n";
    for (const StepAction& action : actions_) {
      out_ << fmt::format("-- {}: {}\n", step_name(action),
                          comment_text(to_string(action, system_)));
    }
    write_main();
    for (std::uint32_t model = 0; model < system_.models.size(); ++model) write_model(model);
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      write_program(program);
    }
  }

 private:
  const std::string& step_name(const StepAction& action) {
    return names_.of(action, system_, true);
  }
  const std::string& instance(std::string_view kind, const std::string& name) {
    return names_.of({kind, name});
  }
  // A definition of a module: where it can do its part of an action.
  std::string can(const StepAction& action) {
    return names_.of({"can", names_.of(action, system_, false)});
  }

  void write_main() {
    out_ << "MODULE main\nIVAR\n  step : {idle";
    for (const StepAction& action : actions_) out_ << ", " << step_name(action);
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
    for (const StepAction& action : actions_) {
      out_ << fmt::format("  {} := {};\n", main_can(action), both_can(action));
    }
    out_ << "  can_step := ";
    for (const StepAction& action : actions_) out_ << main_can(action) << " | ";
    out_ << "FALSE;\n  all_ended := ";
    for (const Program& program : system_.programs) {
      out_ << instance("p", program.name) << ".ended & ";
    }
    out_ << "TRUE;\n  deadlock := !can_step & !all_ended;\nTRANS\n  case\n";
    for (const StepAction& action : actions_) {
      out_ << fmt::format("    step = {} : {};\n", step_name(action), main_can(action));
    }
    out_ << "    TRUE : !can_step;\n  esac;\nINVARSPEC !deadlock;\n";
  }

  std::string main_can(const StepAction& action) { return names_.of({"can", step_name(action)}); }
  // A program knows nothing of what its model was learned for.
  std::string both_can(const StepAction& action) {
    StepAction plain = action;
    plain.is_beyond = false;
    std::string program = instance("p", system_.programs[action.program].name) + "." + can(plain);
    if (action.kind == Kind::choice) return program;
    return program + " & " + instance("m", system_.models[action.model].name) + "." + can(action);
  }

  // The distinct actions at a model's end, each with the steps that are it.
  std::map<std::tuple<Kind, Symbol, bool>, std::vector<StepAction>> actions_at(
      std::uint32_t model) const {
    std::map<std::tuple<Kind, Symbol, bool>, std::vector<StepAction>> result;
    for (const StepAction& action : actions_) {
      if (action.kind == Kind::choice || action.model != model) continue;
      result[{action.kind, action.symbol, action.is_beyond}].push_back(action);
    }
    return result;
  }

  Moves model_moves(const InterfaceAutomaton& automaton, const StepAction& action) const {
    Moves moves;
    if (action.is_beyond) {
      for (const StateId state : states_beyond(automaton, action.symbol)) {
        moves.emplace_back(state, state);
      }
      return moves;
    }
    for (StateId state = 0; state < automaton.size(); ++state) {
      const bool is_quiescent = automaton.is_quiescent(state);
      if (action.kind == Kind::quiet && is_quiescent) moves.emplace_back(state, state);
      if (action.kind == Kind::quiet || (action.kind == Kind::give && !is_quiescent)) continue;
      for (const auto& transition : automaton.transitions(state)) {
        if (transition.absorbed || transition.action.symbol != action.symbol) continue;
        if (transition.action.is_input() != (action.kind == Kind::give)) continue;
        moves.emplace_back(state, transition.target);
      }
    }
    return moves;
  }

  void write_model(std::uint32_t index) {
    const ModelInstance& model = system_.models[index];
    out_ << fmt::format(
        "\n-- model {}: {}\nMODULE {}(step)\nVAR\n  state : 0..{};\nASSIGN\n  init(state) := {};\n",
        comment_text(model.name), comment_text(model.origin), instance("model", model.name),
        model.automaton.size() - 1, model.automaton.initial());
    std::string definitions, cases;
    for (const auto& [key, actions] : actions_at(index)) {
      const Moves moves = model_moves(model.automaton, actions.front());
      definitions +=
          fmt::format("  {} := {};\n", can(actions.front()), membership("state", sources(moves)));
      if (actions.front().kind == Kind::quiet || actions.front().is_beyond) continue;
      std::vector<std::string> steps;
      for (const StepAction& action : actions) steps.push_back(step_name(action));
      cases += fmt::format("    step in {{{}}} :\n        {};\n", fmt::join(steps, ", "),
                           relation("state", moves));
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
    std::map<StepAction, Moves> moves;  // of plain actions
    for (ControlState state = 0; state < program.states.size(); ++state) {
      const std::uint32_t first = program.states[state].first_edge;
      for (std::uint32_t offset = 0; offset < program.states[state].edge_count; ++offset) {
        const Step step{index, first + offset, {}, false, false};
        moves[action_of(system_, step)].emplace_back(state, program.edges[first + offset].target);
      }
    }
    for (const auto& [action, from_to] : moves) {
      out_ << fmt::format("  {} := {};\n", can(action), membership("control", sources(from_to)));
    }
    out_ << "TRANS\n  case\n";
    for (const StepAction& action : actions_) {
      if (action.program != index || is_cut(system_, action)) continue;
      StepAction plain = action;
      plain.is_beyond = false;
      out_ << fmt::format("    step = {} :\n        {};\n", step_name(action),
                          relation("control", moves.at(plain)));
    }
    out_ << "    TRUE : next(control) = control;\n  esac;\n";
  }

  void write_control_definitions(const Program& program) {
    std::vector<std::uint32_t> ends;
    for (ControlState state = 0; state < program.states.size(); ++state) {
      if (program.is_end(state)) ends.push_back(state);
    }
    out_ << fmt::format("  ended := {};\n", membership("control", ends));
    for (std::uint32_t label = 0; label < program.labels.size(); ++label) {
      std::vector<std::uint32_t> states;
      for (ControlState state = 0; state < program.states.size(); ++state) {
        if (program.has_label(state, label)) states.push_back(state);
      }
      out_ << fmt::format("  {} := {};\n", names_.of({"at", program.labels[label]}),
                          membership("control", states));
    }
  }

  std::ostream& out_;
  const System& system_;
  ExportNames names_;
  std::vector<StepAction> actions_;
};

}  // namespace

void write_smv(std::ostream& out, const System& system) {
  refuse_second_edition(system, "SMV");
  Writer(out, system).write();
}

}  // namespace maide
