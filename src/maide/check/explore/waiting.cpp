#include "maide/check/explore/waiting.hpp"

#include <algorithm>
#include <functional>
#include <iterator>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;
using Levels = std::vector<std::optional<std::size_t>>;

bool contains_sorted(const std::vector<Symbol>& sorted, Symbol symbol) {
  return std::binary_search(sorted.begin(), sorted.end(), symbol);
}

void sort_unique(std::vector<Symbol>& symbols) {
  std::sort(symbols.begin(), symbols.end());
  symbols.erase(std::unique(symbols.begin(), symbols.end()), symbols.end());
}

bool uses_model(const Program& program, const ProgramEdge& edge, std::uint32_t model) {
  const auto uses = program.uses_of(edge);
  return std::any_of(uses.begin(), uses.end(),
                     [&](const ModelUse& use) { return use.model == model; });
}

// Inputs of the actors that have one of the outputs.
std::vector<Symbol> asking_by_actors(const InterfaceAutomaton& automaton, const Awaited& awaited) {
  std::vector<Symbol> asking;
  for (const Actor& actor : automaton.actors) {
    const bool has_output =
        std::any_of(awaited.outputs.begin(), awaited.outputs.end(), [&](Symbol output) {
          const std::string& name = automaton.outputs().name(output);
          return std::find(actor.outputs.begin(), actor.outputs.end(), name) != actor.outputs.end();
        });
    if (!has_output) continue;
    for (const std::string& input : actor.inputs) {
      if (const auto symbol = automaton.inputs().find(input)) asking.push_back(*symbol);
    }
  }
  return asking;
}

// Inputs after which a program takes one of the outputs.
std::vector<Symbol> asking_by_programs(const System& system, const Awaited& awaited) {
  std::vector<Symbol> asking;
  const auto takes = [&](const Program& program, const ProgramEdge& edge) {
    const auto events = program.events_of(edge);
    return std::any_of(events.begin(), events.end(), [&](const ModelUse& event) {
      return event.kind == Kind::take && event.model == awaited.model &&
             contains_sorted(awaited.outputs, event.symbol);
    });
  };
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      const auto next = program.edges_of(edge.target);
      const bool is_answered = takes(program, edge) ||
                               std::any_of(next.begin(), next.end(),
                                           [&](const auto& take) { return takes(program, take); });
      if (!is_answered) continue;
      for (const ModelUse& event : program.events_of(edge)) {
        if (event.kind == Kind::give && event.model == awaited.model) {
          asking.push_back(event.symbol);
        }
      }
    }
  }
  return asking;
}

bool is_asked(const Awaited& awaited, const InterfaceAutomaton::Transition& transition) {
  if (transition.absorbed) return false;
  return !transition.action.is_input() || contains_sorted(awaited.asking, transition.action.symbol);
}

bool is_awaited(const Awaited& awaited, Action action) {
  return !action.is_input() && contains_sorted(awaited.outputs, action.symbol);
}

// What can be had from the state by asking, if `counts` can be had from its successors; a number
// beyond the states' stands for any.
std::size_t count_from(const InterfaceAutomaton& automaton, const Awaited& awaited,
                       const std::vector<std::size_t>& counts, StateId state) {
  std::size_t count = 0;
  for (const auto& transition : automaton.transitions(state)) {
    if (!is_asked(awaited, transition)) continue;
    const std::size_t more = is_awaited(awaited, transition.action) ? 1 : 0;
    count = std::max(count, std::min(automaton.size() + 1, counts[transition.target] + more));
  }
  return count;
}

bool is_fixed_point(const InterfaceAutomaton& automaton, const Awaited& awaited,
                    const std::vector<std::size_t>& counts) {
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (count_from(automaton, awaited, counts, state) != counts[state]) return false;
  }
  return true;
}

// Inputs that somewhere raise what can be had.
std::vector<Symbol> find_messages(const InterfaceAutomaton& automaton, const Awaited& awaited,
                                  const Levels& levels) {
  std::vector<Symbol> messages;
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (!transition.action.is_input() || transition.absorbed) continue;
      if (contains_sorted(awaited.asking, transition.action.symbol)) continue;
      if (levels[state] && levels[transition.target] &&
          *levels[transition.target] > *levels[state]) {
        messages.push_back(transition.action.symbol);
      }
    }
  }
  sort_unique(messages);
  return messages;
}

// The awaited outputs that come if one asks, in order, up to `most`: of each state the first way.
std::vector<Symbol> outputs_from(const InterfaceAutomaton& automaton, const Awaited& awaited,
                                 const Levels& levels, StateId state, std::size_t most) {
  std::vector<Symbol> outputs;
  for (std::size_t steps = 0; outputs.size() < most && steps < automaton.size() * 2; ++steps) {
    const auto transitions = automaton.transitions(state);
    const auto next = std::find_if(transitions.begin(), transitions.end(), [&](const auto& way) {
      if (!is_asked(awaited, way) || !levels[way.target]) return false;
      return *levels[way.target] + (is_awaited(awaited, way.action) ? 1 : 0) == *levels[state] &&
             way.target != state;
    });
    if (next == transitions.end()) break;
    if (is_awaited(awaited, next->action)) outputs.push_back(next->action.symbol);
    state = next->target;
  }
  return outputs;
}

// Which message was lost, if the model's messages tell that one is missing before them
// (payload=gap).
MessageAccount::Loss::Which which_was_lost(const InterfaceAutomaton& automaton,
                                           const Awaited& awaited, const Levels& levels,
                                           StateId before, StateId after) {
  using Which = MessageAccount::Loss::Which;
  const auto gap = automaton.outputs().find("gap");
  if (!gap || !contains_sorted(awaited.outputs, *gap)) return Which::unknown;
  const std::size_t held = *levels[before];
  const auto old_outputs = outputs_from(automaton, awaited, levels, before, held);
  const auto new_outputs = outputs_from(automaton, awaited, levels, after, held);
  if (held == 0 || old_outputs == new_outputs) return Which::newest;
  return new_outputs.front() == *gap ? Which::oldest : Which::unknown;
}

// Whether each loss stands at a step of the run, behind the one before it, and counts no more than
// was given.
bool is_consistent(const MessageAccount& account, const Trace& trace) {
  const auto& losses = account.losses;
  const bool is_ordered =
      std::adjacent_find(losses.begin(), losses.end(), [](const auto& one, const auto& next) {
        return one.step >= next.step || one.given > next.given || one.taken > next.taken;
      }) == losses.end();
  return is_ordered && std::all_of(losses.begin(), losses.end(), [&](const auto& loss) {
           return loss.step < trace.steps.size() && loss.count > 0 && loss.given <= account.given &&
                  loss.taken <= account.taken;
         });
}

}  // namespace

std::size_t MessageAccount::lost() const {
  std::size_t count = 0;
  for (const Loss& loss : losses) count += loss.count;
  return count;
}

std::optional<Awaited> find_awaited(const System& system, const Program& program,
                                    ControlState state) {
  Awaited awaited;
  for (const ProgramEdge& edge : program.edges_of(state)) {
    if (edge.kind != Kind::take) continue;
    awaited.model = edge.model;
    awaited.outputs.push_back(edge.symbol);
  }
  if (awaited.outputs.empty()) return std::nullopt;
  sort_unique(awaited.outputs);
  awaited.asking = asking_by_actors(system.models[awaited.model].automaton, awaited);
  if (awaited.asking.empty()) awaited.asking = asking_by_programs(system, awaited);
  sort_unique(awaited.asking);
  return awaited;
}

std::vector<std::optional<std::size_t>> count_obtainable(const InterfaceAutomaton& automaton,
                                                         const Awaited& awaited) {
  // Least solution from below; more outputs than there are states means a cycle with one.
  const std::size_t most = automaton.size();
  std::vector<std::size_t> counts(automaton.size(), 0);
  std::vector<std::vector<StateId>> sources(automaton.size());
  std::vector<StateId> open;
  for (StateId state = 0; state < automaton.size(); ++state) {
    open.push_back(state);
    for (const auto& transition : automaton.transitions(state)) {
      if (is_asked(awaited, transition)) sources[transition.target].push_back(state);
    }
  }
  while (!open.empty()) {
    const StateId state = open.back();
    open.pop_back();
    const std::size_t count = count_from(automaton, awaited, counts, state);
    if (count == counts[state]) continue;
    MAIDE_CHECK(count > counts[state]);  // or it need not end
    counts[state] = count;
    open.insert(open.end(), sources[state].begin(), sources[state].end());
  }
  MAIDE_CHECK(is_fixed_point(automaton, awaited, counts));
  std::vector<std::optional<std::size_t>> result;
  for (const std::size_t count : counts) {
    result.push_back(count > most ? std::nullopt : std::optional(count));
  }
  return result;
}

std::optional<MessageAccount> take_account(const System& system, const Trace& trace,
                                           const std::vector<GlobalState>& states,
                                           const Awaited& awaited) {
  const InterfaceAutomaton& automaton = system.models[awaited.model].automaton;
  MAIDE_CHECK(states.size() == trace.steps.size() + 1);
  const Levels levels = count_obtainable(automaton, awaited);
  MessageAccount account;
  account.messages = find_messages(automaton, awaited, levels);
  if (account.messages.empty()) return std::nullopt;
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    const Program& program = system.programs[step.program];
    const ProgramEdge& edge = program.edges[step.edge];
    if (!uses_model(program, edge, awaited.model)) continue;
    bool gives = false, takes = false, is_message = false;
    for (const ModelUse& event : program.events_of(edge)) {
      if (event.model != awaited.model) continue;
      gives = gives || event.kind == Kind::give;
      takes = takes || event.kind == Kind::take;
      is_message = is_message ||
                   (event.kind == Kind::give && contains_sorted(account.messages, event.symbol));
    }
    const StateId before = states[at].models[awaited.model];
    const StateId after = states[at + 1].models[awaited.model];
    if (!levels[before] || !levels[after]) return std::nullopt;
    const std::size_t held = *levels[before], now = *levels[after];
    if (is_message) {
      ++account.given;
      account.givers.insert(step.program);
      if (now > held + 1) return std::nullopt;  // one input, several messages: not countable
      if (now == held + 1) continue;
      account.losses.push_back({at, account.given, account.taken, held, held + 1 - now,
                                which_was_lost(automaton, awaited, levels, before, after)});
    } else if (takes && now + 1 == held) {
      ++account.taken;
      account.takers.insert(step.program);
    } else if (gives && now < held) {
      account.losses.push_back({at, account.given, account.taken, held, held - now,
                                MessageAccount::Loss::Which::unknown});
    } else if (now != held) {
      return std::nullopt;
    }
  }
  const std::size_t first = levels[states.front().models[awaited.model]].value_or(0);
  account.held = levels[states.back().models[awaited.model]].value_or(0);
  if (first + account.given != account.taken + account.lost() + account.held) return std::nullopt;
  MAIDE_CHECK(is_consistent(account, trace));
  return account;
}

namespace {

using Kind = ProgramEdge::Kind;
using Reason = Waiting::Reason;
using Helps = std::function<bool(const Program&, const ProgramEdge&)>;

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
      if (helps(program, edge)) return true;
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
    std::copy_if(edges.begin(), edges.end(), std::back_inserter(waiting_.awaited),
                 [&](const ProgramEdge& edge) { return !own().is_death(edge); });
    const auto& awaited = waiting_.awaited;
    const bool is_plain = std::all_of(awaited.begin(), awaited.end(), [&](const auto& edge) {
      return (edge.kind == Kind::give || edge.kind == Kind::take || edge.kind == Kind::quiet) &&
             edge.model == awaited.front().model;
    });
    if (is_plain && !awaited.empty()) {
      waiting_.model = waiting_.awaited.front().model;
    } else {
      waiting_.reason = Reason::several;
    }
  }

  Waiting run() {
    if (waiting_.reason == Reason::several) {
      find_users();
      MAIDE_CHECK(is_consistent());
      return std::move(waiting_);
    }
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
    MAIDE_CHECK(is_consistent());
    return std::move(waiting_);
  }

 private:
  // Whether the parts of the answer agree: causes lie before the position, only what is due keeps
  // the model from the rest, and the helpers are other programs.
  bool is_consistent() const {
    const Waiting& waiting = waiting_;
    const bool is_due = waiting.reason == Reason::output_due;
    const auto& helpers = waiting.helpers;
    const auto& reachable = waiting.reachable_helpers;
    return waiting.due.empty() != is_due && (!waiting.cause || *waiting.cause < at_) &&
           (!waiting.account || waiting.reason == Reason::nothing_due) &&
           std::includes(helpers.begin(), helpers.end(), reachable.begin(), reachable.end()) &&
           !contains(helpers, waiting.program) && waiting.number <= waiting.count;
  }

  const Program& own() const { return system_.programs[waiting_.program]; }
  const InterfaceAutomaton& automaton() const { return system_.models[waiting_.model].automaton; }

  // The last step before `at_` with the model that `is_it` accepts.
  std::optional<std::size_t> last_step(const std::function<bool(std::size_t)>& is_it) const {
    for (std::size_t step = at_; step-- > 0;) {
      const Program& program = system_.programs[trace_.steps[step].program];
      const ProgramEdge& edge = edge_of(system_, trace_.steps[step]);
      if (uses_model(program, edge, waiting_.model) && is_it(step)) return step;
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
      const auto events = system_.programs[trace_.steps[step].program].events_of(
          edge_of(system_, trace_.steps[step]));
      return std::any_of(events.begin(), events.end(), [&](const ModelUse& event) {
        return event.kind == Kind::give && event.model == waiting_.model &&
               contains(actor, event.symbol);
      });
    });
    waiting_.wanted = other_inputs(automaton(), actor);
  }

  void find_helpers() {
    const Kind kind = waiting_.reason == Reason::output_due ? Kind::take : Kind::give;
    add_helpers([&](const Program& program, const ProgramEdge& edge) {
      const auto events = program.events_of(edge);
      return std::any_of(events.begin(), events.end(), [&](const ModelUse& event) {
        return event.kind == kind && event.model == waiting_.model &&
               contains(waiting_.wanted, event.symbol);
      });
    });
  }

  // Who uses a model that one of the awaited steps uses might make it possible.
  void find_users() {
    add_helpers([&](const Program& program, const ProgramEdge& edge) {
      return std::any_of(waiting_.awaited.begin(), waiting_.awaited.end(),
                         [&](const ProgramEdge& awaited) {
                           const auto uses = own().uses_of(awaited);
                           return std::any_of(uses.begin(), uses.end(), [&](const ModelUse& use) {
                             return uses_model(program, edge, use.model);
                           });
                         });
    });
  }

  void add_helpers(const Helps& helps) {
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      const Program& program = system_.programs[index];
      if (index == waiting_.program) continue;
      if (std::none_of(program.edges.begin(), program.edges.end(),
                       [&](const ProgramEdge& edge) { return helps(program, edge); })) {
        continue;
      }
      waiting_.helpers.push_back(index);
      if (can_reach(program, state_.programs[index], helps)) {
        waiting_.reachable_helpers.push_back(index);
      }
    }
  }

  bool is_awaited_step(const ProgramEdge& edge) const {
    return std::any_of(waiting_.awaited.begin(), waiting_.awaited.end(), [&](const auto& other) {
      return edge.kind == other.kind && edge.model == other.model && edge.symbol == other.symbol;
    });
  }

  // In which round of the innermost `repeat` it is, and how many of the awaited it has had there.
  void find_number() {
    const Program& program = own();
    const auto round_at = [&](std::size_t at) -> const Program::Round& {
      return program.rounds[program.states[states_[at].programs[waiting_.program]].round];
    };
    const Program::Round& round = round_at(at_);
    if (round.count < 2) return;
    std::uint32_t done = 0, number = round.number;
    for (std::size_t step = at_; step-- > 0;) {
      if (trace_.steps[step].program != waiting_.program) continue;
      const Program::Round& before = round_at(step);
      const bool is_within = before.line == round.line && before.column == round.column &&
                             before.outer == round.outer && before.number <= number;
      if (!is_within) break;
      number = before.number;
      done += is_awaited_step(edge_of(system_, trace_.steps[step])) ? 1 : 0;
    }
    waiting_.round = round.number;
    waiting_.rounds = round.count;
    waiting_.number = done + 1;
    waiting_.is_once_a_round = done + 1 == round.number && is_once_a_round(round);
  }

  // Whether control comes to the awaited once in each round of the loop, whichever way it goes.
  bool is_once_a_round(const Program::Round& loop) const {
    const Program& program = own();
    std::vector<std::uint32_t> numbers(program.rounds.size());  // of the round around it; 0: none
    for (std::size_t index = 1; index < numbers.size(); ++index) {
      for (std::size_t at = index; at != 0; at = program.rounds[at].outer) {
        const Program::Round& round = program.rounds[at];
        if (round.line != loop.line || round.column != loop.column || round.outer != loop.outer) {
          continue;
        }
        numbers[index] = round.number;
        break;
      }
    }
    const auto number = [&](ControlState state) { return numbers[program.states[state].round]; };
    enum Way : std::uint8_t { before = 1, behind = 2 };  // the awaited step of the round
    std::vector<std::uint8_t> seen(program.states.size());
    std::vector<std::pair<ControlState, Way>> open;
    const auto see = [&](ControlState state, Way way) {
      if (number(state) == 0 || (seen[state] & way) != 0) return;
      seen[state] |= way;
      open.emplace_back(state, way);
    };
    see(0, before);
    for (ControlState state = 0; state < program.states.size(); ++state) {
      for (const ProgramEdge& edge : program.edges_of(state)) {
        if (number(state) != number(edge.target)) see(edge.target, before);
      }
    }
    while (!open.empty()) {
      const auto [state, way] = open.back();
      open.pop_back();
      for (const ProgramEdge& edge : program.edges_of(state)) {
        if (program.is_death(edge)) continue;
        const bool is_it = is_awaited_step(edge);
        if (is_it && way == behind) return false;
        const bool leaves = number(state) != number(edge.target);
        if (leaves && !is_it && way == before) return false;
        if (!leaves) see(edge.target, is_it ? behind : way);
      }
    }
    return true;
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
  MAIDE_CHECK(at < states.size() && at <= trace.steps.size());
  MAIDE_CHECK(contains(blocked_programs(system, states[at]), program));
  return WaitingFinder(system, trace, states, at, program).run();
}

std::vector<std::uint32_t> blocked_programs(const System& system, const GlobalState& state) {
  std::vector<bool> can_step(system.programs.size());
  for (const Step& step : enabled_steps(system, state)) {
    const Program& program = system.programs[step.program];
    if (!program.is_death(program.edges[step.edge])) can_step[step.program] = true;
  }
  std::vector<std::uint32_t> blocked;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const Program::State& at = program.states[state.programs[index]];
    if (!can_step[index] && at.edge_count > 0 && at.error == 0 && !at.may_rest) {
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
    MAIDE_CHECK(path.size() <= waitings.size());
    program = waiting->reachable_helpers.front();
    if (program == path.front()) return path;
    if (contains(path, program)) return {};
  }
}

}  // namespace maide
