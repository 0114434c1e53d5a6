// A system as one mCRL2 specification.
#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "maide/check/explore/step_action.hpp"
#include "maide/check/export/system_exporters.hpp"
#include "maide/formats/exporters.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

class Writer {
 public:
  Writer(std::ostream& out, const System& system)
      : out_(out), system_(system), names_(mcrl2_reserved()) {
    names_.of({"Program"});
    names_.of({"p"});
    for (StepAction action : step_actions(system)) {
      action.program = 0;  // an argument of the action
      actions_.insert(action);
    }
  }

  void write() {
    out_ << "% " << comment_text(system_.file) << "\n";
    write_declarations();
    for (std::uint32_t model = 0; model < system_.models.size(); ++model) write_model(model);
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      write_program(program);
    }
    write_composition();
  }

 private:
  std::string name(const StepAction& action) { return names_.of(action, system_, false); }
  std::string half(std::string_view side, const StepAction& action) {
    return names_.of({side, name(action)});
  }
  std::string program_value(std::uint32_t program) {
    return names_.of({"prog", system_.programs[program].name});
  }
  std::string process(std::string_view kind, const std::string& component, std::uint32_t state) {
    return names_.of({kind, component, std::to_string(state)});
  }

  void write_declarations() {
    std::vector<std::string> values, visible, halves;
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      values.push_back(program_value(program));
    }
    for (const StepAction& action : actions_) {
      visible.push_back(name(action));
      if (action.kind == Kind::choice) continue;
      halves.push_back(half("p", action));
      halves.push_back(half("m", action));
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
    for (StateId state = 0; state < model.automaton.size(); ++state) {
      std::vector<std::string> summands;
      for (const StepAction& action : actions_) {
        if (action.kind == Kind::choice || action.model != index) continue;
        for (const StateId target : targets(model.automaton, state, action)) {
          summands.push_back(fmt::format("(sum p: Program . {}(p)) . {}", half("m", action),
                                         process("Model", model.name, target)));
        }
      }
      write_process(process("Model", model.name, state), summands);
    }
  }

  // Where the model may be after its part of the action; nothing if it does not take part.
  static std::vector<StateId> targets(const InterfaceAutomaton& automaton, StateId state,
                                      const StepAction& action) {
    std::vector<StateId> result;
    const bool is_quiescent = automaton.is_quiescent(state);
    if (action.kind != Kind::take && !is_quiescent) return result;
    if (action.kind == Kind::quiet) return {state};
    if (action.is_beyond) {
      if (is_beyond_learned(automaton, state, action.symbol)) result.push_back(state);
      return result;
    }
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.absorbed || transition.action.symbol != action.symbol) continue;
      if (transition.action.is_input() != (action.kind == Kind::give)) continue;
      result.push_back(transition.target);
    }
    return result;
  }

  void write_program(std::uint32_t index) {
    const Program& program = system_.programs[index];
    out_ << fmt::format("  % program {}, line {}\n", comment_text(program.name),
                        program.position.line);
    const std::string value = program_value(index);
    for (ControlState state = 0; state < program.states.size(); ++state) {
      std::vector<std::string> summands;
      const std::uint32_t first = program.states[state].first_edge;
      for (std::uint32_t edge = first; edge < first + program.states[state].edge_count; ++edge) {
        const std::string target = process("Program", program.name, program.edges[edge].target);
        StepAction action = action_of(system_, {index, edge, {}, false, false});
        action.program = 0;
        const bool is_alone = action.kind == Kind::choice;
        summands.push_back(
            fmt::format("{}({}) . {}", is_alone ? name(action) : half("p", action), value, target));
        action.is_beyond = true;
        if (!actions_.contains(action)) continue;
        summands.push_back(fmt::format(
            "{}({}) . {}", half("p", action), value,
            is_cut(system_, action) ? process("Program", program.name, state) : target));
      }
      write_process(process("Program", program.name, state), summands);
    }
  }

  void write_composition() {
    std::vector<std::string> visible, meetings, parts;
    for (const StepAction& action : actions_) {
      visible.push_back(name(action));
      if (action.kind == Kind::choice) continue;
      meetings.push_back(
          fmt::format("{} | {} -> {}", half("p", action), half("m", action), name(action)));
    }
    for (const ModelInstance& model : system_.models) {
      parts.push_back(process("Model", model.name, model.automaton.initial()));
    }
    for (const Program& program : system_.programs) {
      parts.push_back(process("Program", program.name, 0));
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
  ExportNames names_;
  std::set<StepAction> actions_;  // as if all were the first program's
};

}  // namespace

void write_mcrl2(std::ostream& out, const System& system) {
  refuse_second_edition(system, "mCRL2");
  Writer(out, system).write();
}

}  // namespace maide
