#include "maide/check/message_account.hpp"

#include <algorithm>

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;
using Levels = std::vector<std::optional<std::size_t>>;

bool contains(const std::vector<Symbol>& sorted, Symbol symbol) {
  return std::binary_search(sorted.begin(), sorted.end(), symbol);
}

void sort_unique(std::vector<Symbol>& symbols) {
  std::sort(symbols.begin(), symbols.end());
  symbols.erase(std::unique(symbols.begin(), symbols.end()), symbols.end());
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
  for (const Program& program : system.programs) {
    for (const ProgramEdge& give : program.edges) {
      if (give.kind != Kind::give || give.model != awaited.model) continue;
      for (const ProgramEdge& take : program.edges_of(give.target)) {
        if (take.kind == Kind::take && take.model == awaited.model &&
            contains(awaited.outputs, take.symbol)) {
          asking.push_back(give.symbol);
        }
      }
    }
  }
  return asking;
}

bool is_asked(const Awaited& awaited, const InterfaceAutomaton::Transition& transition) {
  if (transition.absorbed) return false;
  return !transition.action.is_input() || contains(awaited.asking, transition.action.symbol);
}

bool is_awaited(const Awaited& awaited, Action action) {
  return !action.is_input() && contains(awaited.outputs, action.symbol);
}

// Inputs that somewhere raise what can be had.
std::vector<Symbol> find_messages(const InterfaceAutomaton& automaton, const Awaited& awaited,
                                  const Levels& levels) {
  std::vector<Symbol> messages;
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (!transition.action.is_input() || transition.absorbed) continue;
      if (contains(awaited.asking, transition.action.symbol)) continue;
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
  if (!gap || !contains(awaited.outputs, *gap)) return Which::unknown;
  const std::size_t held = *levels[before];
  const auto old_outputs = outputs_from(automaton, awaited, levels, before, held);
  const auto new_outputs = outputs_from(automaton, awaited, levels, after, held);
  if (held == 0 || old_outputs == new_outputs) return Which::newest;
  return new_outputs.front() == *gap ? Which::oldest : Which::unknown;
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
    std::size_t count = counts[state];
    for (const auto& transition : automaton.transitions(state)) {
      if (!is_asked(awaited, transition)) continue;
      const std::size_t more = is_awaited(awaited, transition.action) ? 1 : 0;
      count = std::max(count, std::min(most + 1, counts[transition.target] + more));
    }
    if (count == counts[state]) continue;
    counts[state] = count;
    open.insert(open.end(), sources[state].begin(), sources[state].end());
  }
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
  const Levels levels = count_obtainable(automaton, awaited);
  MessageAccount account;
  account.messages = find_messages(automaton, awaited, levels);
  if (account.messages.empty()) return std::nullopt;
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    const ProgramEdge& edge = system.programs[step.program].edges[step.edge];
    if (edge.kind == Kind::choice || edge.model != awaited.model) continue;
    const StateId before = states[at].models[awaited.model];
    const StateId after = states[at + 1].models[awaited.model];
    if (!levels[before] || !levels[after]) return std::nullopt;
    const std::size_t held = *levels[before], now = *levels[after];
    const bool is_message = edge.kind == Kind::give && contains(account.messages, edge.symbol);
    if (is_message) {
      ++account.given;
      account.givers.insert(step.program);
      if (now > held + 1) return std::nullopt;  // one input, several messages: not countable
      if (now == held + 1) continue;
      account.losses.push_back({at, account.given, account.taken, held, held + 1 - now,
                                which_was_lost(automaton, awaited, levels, before, after)});
    } else if (edge.kind == Kind::take && now + 1 == held) {
      ++account.taken;
      account.takers.insert(step.program);
    } else if (edge.kind == Kind::give && now < held) {
      account.losses.push_back({at, account.given, account.taken, held, held - now,
                                MessageAccount::Loss::Which::unknown});
    } else if (now != held) {
      return std::nullopt;
    }
  }
  const std::size_t first = levels[states.front().models[awaited.model]].value_or(0);
  account.held = levels[states.back().models[awaited.model]].value_or(0);
  if (first + account.given != account.taken + account.lost() + account.held) return std::nullopt;
  return account;
}

}  // namespace maide
