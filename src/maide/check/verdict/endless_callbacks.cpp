#include "maide/check/verdict/endless_callbacks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "maide/check/verdict/ways_out.hpp"

namespace maide {
namespace {

// Where the code of a callback may go round for ever: cycles without the end of a callback, and
// without a look for others. A step that cuts the run goes nowhere.
std::set<int> find_endless_lines(const System& system, const Program& program) {
  const auto cuts_run = [&](const ProgramEdge& edge) {
    const auto uses = program.uses_of(edge);
    return std::ranges::any_of(uses, [&](const ModelUse& use) {
      if (use.kind != ModelUse::Kind::act) return false;
      const auto& steps = system.models[use.model].actions[use.index].steps;
      return std::ranges::all_of(steps, [](const auto& of_state) {
        return std::ranges::all_of(of_state, &ModelStep::is_beyond);
      });
    });
  };
  std::vector<std::uint8_t> seen(program.states.size(), 0);  // 1 on the path, 2 done
  std::vector<std::pair<ControlState, std::uint32_t>> path;
  std::set<int> lines;
  for (ControlState start = 0; start < program.states.size(); ++start) {
    if (seen[start] != 0) continue;
    path.emplace_back(start, 0);
    seen[start] = 1;
    while (!path.empty()) {
      auto& [state, next] = path.back();
      const auto edges = program.edges_of(state);
      if (next == edges.size()) {
        seen[state] = 2;
        path.pop_back();
        continue;
      }
      const ProgramEdge& edge = edges[next++];
      const CombinedStep::Role role = program.role_of(edge);
      if (role == CombinedStep::Role::end || role == CombinedStep::Role::look) continue;
      if (program.is_fate(edge) || cuts_run(edge)) continue;
      if (seen[edge.target] == 1) lines.insert(edge.line);
      if (seen[edge.target] != 0) continue;
      seen[edge.target] = 1;
      path.emplace_back(edge.target, 0);
    }
  }
  return lines;
}

}  // namespace

std::map<std::uint32_t, EndlessLines> find_endless_callbacks(const System& system) {
  std::map<std::uint32_t, EndlessLines> found;
  for (std::uint32_t number = 0; number < system.programs.size(); ++number) {
    const Program& program = system.programs[number];
    if (!program.runs_callbacks()) continue;
    EndlessLines lines{find_endless_lines(system, program), {}};
    for (const SourcePosition& spin : program.spins_until) lines.spins.insert(spin.line);
    if (!lines.loops.empty() || !lines.spins.empty()) found.emplace(number, std::move(lines));
  }
  return found;
}

EndlessQuestion ask_whether_endless(const System& system, std::uint32_t number, bool spins) {
  EndlessQuestion question{system, {}};
  Program& program = question.system.programs[number];
  const auto elsewhere = static_cast<std::uint32_t>(program.labels.size());
  const std::uint32_t inside = elsewhere + 1, between = elsewhere + 2;
  program.labels.insert(program.labels.end(),
                        {"elsewhere", "in a callback", "between two of a spin"});
  const auto callbacks = callbacks_in(program);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> marked;  // by set and label
  for (ControlState state = 0; state < program.states.size(); ++state) {
    const std::uint32_t label = callbacks[state]                    ? inside
                                : program.spins_until_answer(state) ? between
                                                                    : elsewhere;
    std::uint32_t& labels = program.states[state].label_set;
    const auto [known, is_new] =
        marked.try_emplace({labels, label}, static_cast<std::uint32_t>(program.label_sets.size()));
    if (is_new) {
      std::vector<std::uint32_t> more = program.label_sets[labels];
      more.push_back(label);
      program.label_sets.push_back(std::move(more));
    }
    labels = known->second;
  }
  using Operator = FormulaNode::Operator;
  const auto at = [&](std::uint32_t label) {
    return make_formula(Atom{Atom::Kind::label, number, label});
  };
  const auto again = [](const Formula& formula) {
    return make_formula(Operator::globally, make_formula(Operator::finally, formula));
  };
  const auto in_the_end = [](const Formula& formula) {
    return make_formula(Operator::finally, make_formula(Operator::globally, formula));
  };
  question.property.name = "stuck";
  question.property.fairness = Fairness::strong;
  // Who stands still in a spin or a callback is no matter of this.
  question.property.formula =
      spins ? make_formula(Operator::disjunction, again(at(elsewhere)),
                           make_formula(Operator::disjunction, in_the_end(at(between)),
                                        in_the_end(at(inside))))
            : again(make_formula(Operator::negation, at(inside)));
  return question;
}

std::string describe_endless(const EndlessLines& lines) {
  std::string text;
  if (!lines.loops.empty()) {
    text = fmt::format(
        "the code of a callback may go round for ever at line{} {}, and what its thread or group "
        "keeps from starting then is not looked at",
        lines.loops.size() == 1 ? "" : "s", fmt::join(lines.loops, ", "));
  }
  if (lines.spins.empty()) return text;
  return text + (text.empty() ? "" : "; ") +
         fmt::format(
             "callbacks may run for ever at the `spin until` of line{} {}, whose answer never "
             "comes (a formula says that it comes: `F node.main@label`)",
             lines.spins.size() == 1 ? "" : "s", fmt::join(lines.spins, ", "));
}

}  // namespace maide
