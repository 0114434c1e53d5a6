#include "maide/check/waiting.hpp"

#include <algorithm>
#include <functional>

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;
using Reason = Waiting::Reason;
using Helps = std::function<bool(const ProgramEdge&)>;

const ProgramEdge& edge_of(const System& system, const Step& step) {
  return system.programs[step.program].edges[step.edge];
}

bool contains(const std::vector<Symbol>& symbols, Symbol symbol) {
  return std::find(symbols.begin(), symbols.end(), symbol) != symbols.end();
}

std::vector<Symbol> outputs_due(const InterfaceAutomaton& automaton, StateId state) {
  std::vector<Symbol> due;
  for (const auto& transition : automaton.transitions(state)) {
    if (!transition.action.is_input() && !contains(due, transition.action.symbol)) {
      due.push_back(transition.action.symbol);
    }
  }
  return due;
}

// Whether the program can come from `start` to an edge that helps.
bool can_reach(const Program& program, ControlState start, const Helps& helps) {
  std::vector<bool> seen(program.states.size());
  std::vector<ControlState> open{start};
  seen[start] = true;
  while (!open.empty()) {
    const ControlState state = open.back();
    open.pop_back();
    for (const ProgramEdge& edge : program.edges_of(state)) {
      if (helps(edge)) return true;
      if (seen[edge.target]) continue;
      seen[edge.target] = true;
      open.push_back(edge.target);
    }
  }
  return false;
}

// Inputs of the same actor, the input itself among them; only itself if the actors are not known.
std::vector<Symbol> same_actor(const InterfaceAutomaton& automaton, Symbol input) {
  const std::string& name = automaton.inputs().name(input);
  std::vector<Symbol> symbols{input};
  for (const Actor& actor : automaton.actors) {
    if (std::find(actor.inputs.begin(), actor.inputs.end(), name) == actor.inputs.end()) continue;
    for (const std::string& other : actor.inputs) {
      if (const auto symbol = automaton.inputs().find(other)) symbols.push_back(*symbol);
    }
  }
  return symbols;
}

std::vector<Symbol> other_inputs(const InterfaceAutomaton& automaton,
                                 const std::vector<Symbol>& known) {
  std::vector<Symbol> others;
  for (Symbol input = 0; input < automaton.inputs().size(); ++input) {
    if (!contains(known, input)) others.push_back(input);
  }
  return others;
}

class WaitingFinder {
 public:
  WaitingFinder(const System& system, const Trace& trace, const std::vector<GlobalState>& states,
                std::size_t at, std::uint32_t program)
      : system_(system), trace_(trace), states_(states), at_(at), state_(states[at]) {
    waiting_.program = program;
    const auto edges = own().edges_of(state_.programs[program]);
    waiting_.awaited.assign(edges.begin(), edges.end());
    waiting_.model = edges.front().model;
  }

  Waiting run() {
    waiting_.due = outputs_due(automaton(), state_.models[waiting_.model]);
    const ProgramEdge& first = waiting_.awaited.front();
    if (!waiting_.due.empty()) {
      explain_due();
    } else if (first.kind != Kind::give) {
      explain_silence();
    } else if (is_beyond_learned(automaton(), state_.models[waiting_.model], first.symbol)) {
      waiting_.reason = Reason::bound;
      waiting_.wanted = other_inputs(automaton(), same_actor(automaton(), first.symbol));
    } else {
      explain_refusal(first.symbol);
    }
    find_helpers();
    find_number();
    return std::move(waiting_);
  }

 private:
  const Program& own() const { return system_.programs[waiting_.program]; }
  const InterfaceAutomaton& automaton() const { return system_.models[waiting_.model].automaton; }

  // The last step before `at_` with the model that `is_it` accepts.
  std::optional<std::size_t> last_step(const std::function<bool(std::size_t)>& is_it) const {
    for (std::size_t step = at_; step-- > 0;) {
      const ProgramEdge& edge = edge_of(system_, trace_.steps[step]);
      if (edge.kind == Kind::choice || edge.model != waiting_.model) continue;
      if (is_it(step)) return step;
    }
    return std::nullopt;
  }

  void explain_due() {
    waiting_.reason = Reason::output_due;
    waiting_.wanted = waiting_.due;
    // Since the model was quiescent last.
    waiting_.cause = last_step([&](std::size_t step) {
      return automaton().is_quiescent(states_[step].models[waiting_.model]);
    });
  }

  void explain_silence() {
    waiting_.reason = Reason::nothing_due;
    const auto awaited = find_awaited(system_, own(), state_.programs[waiting_.program]);
    if (!awaited) return;
    const Trace so_far{{trace_.steps.begin(), trace_.steps.begin() + static_cast<long>(at_)}, {}};
    const std::vector<GlobalState> states(states_.begin(),
                                          states_.begin() + static_cast<long>(at_) + 1);
    waiting_.account = take_account(system_, so_far, states, *awaited);
    // What is held, and cannot be had, was not asked for.
    if (waiting_.account && waiting_.account->held > 0) {
      waiting_.wanted = awaited->asking;
    } else if (waiting_.account) {
      waiting_.wanted = waiting_.account->messages;
    } else {
      waiting_.wanted = other_inputs(automaton(), awaited->asking);
    }
  }

  void explain_refusal(Symbol input) {
    waiting_.reason = Reason::busy;
    const std::vector<Symbol> actor = same_actor(automaton(), input);
    waiting_.cause = last_step([&](std::size_t step) {
      const ProgramEdge& edge = edge_of(system_, trace_.steps[step]);
      return edge.kind == Kind::give && contains(actor, edge.symbol);
    });
    waiting_.wanted = other_inputs(automaton(), actor);
  }

  void find_helpers() {
    const Kind kind = waiting_.reason == Reason::output_due ? Kind::take : Kind::give;
    const Helps helps = [&](const ProgramEdge& edge) {
      return edge.kind == kind && edge.model == waiting_.model &&
             contains(waiting_.wanted, edge.symbol);
    };
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      const Program& program = system_.programs[index];
      if (index == waiting_.program) continue;
      if (std::none_of(program.edges.begin(), program.edges.end(), helps)) continue;
      waiting_.helpers.push_back(index);
      if (can_reach(program, state_.programs[index], helps)) {
        waiting_.reachable_helpers.push_back(index);
      }
    }
  }

  // Each round of the innermost `repeat` does the awaited once: which one is it?
  void find_number() {
    const Program& program = own();
    const auto round_at = [&](std::size_t at) -> const Program::Round& {
      return program.rounds[program.states[states_[at].programs[waiting_.program]].round];
    };
    const Program::Round& round = round_at(at_);
    if (round.count < 2) return;
    const auto is_same = [&](const ProgramEdge& edge) {
      return std::any_of(waiting_.awaited.begin(), waiting_.awaited.end(), [&](const auto& other) {
        return edge.kind == other.kind && edge.model == other.model && edge.symbol == other.symbol;
      });
    };
    std::uint32_t done = 0, number = round.number;
    for (std::size_t step = at_; step-- > 0;) {
      if (trace_.steps[step].program != waiting_.program) continue;
      const Program::Round& before = round_at(step);
      const bool is_within = before.line == round.line && before.column == round.column &&
                             before.outer == round.outer && before.number <= number;
      if (!is_within) break;
      number = before.number;
      done += is_same(edge_of(system_, trace_.steps[step])) ? 1 : 0;
    }
    if (done + 1 != round.number) return;
    waiting_.number = round.number;
    waiting_.count = round.count;
  }

  const System& system_;
  const Trace& trace_;
  const std::vector<GlobalState>& states_;
  std::size_t at_;
  const GlobalState& state_;
  Waiting waiting_;
};

}  // namespace

Waiting find_waiting(const System& system, const Trace& trace,
                     const std::vector<GlobalState>& states, std::size_t at,
                     std::uint32_t program) {
  return WaitingFinder(system, trace, states, at, program).run();
}

std::vector<std::uint32_t> blocked_programs(const System& system, const GlobalState& state) {
  std::vector<bool> can_step(system.programs.size());
  for (const Step& step : enabled_steps(system, state)) can_step[step.program] = true;
  std::vector<std::uint32_t> blocked;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    if (!can_step[index] && !system.programs[index].is_end(state.programs[index])) {
      blocked.push_back(index);
    }
  }
  return blocked;
}

std::vector<std::uint32_t> find_circle(const std::vector<Waiting>& waitings) {
  std::vector<std::uint32_t> path;
  if (waitings.empty()) return path;
  for (std::uint32_t program = waitings.front().program;;) {
    const auto waiting =
        std::find_if(waitings.begin(), waitings.end(),
                     [&](const Waiting& candidate) { return candidate.program == program; });
    if (waiting == waitings.end() || waiting->reachable_helpers.size() != 1) return {};
    path.push_back(program);
    program = waiting->reachable_helpers.front();
    if (program == path.front()) return path;
    if (contains(path, program)) return {};
  }
}

}  // namespace maide
