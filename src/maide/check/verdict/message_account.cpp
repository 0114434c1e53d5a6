#include "maide/check/verdict/message_account.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

using EdgeKind = ProgramEdge::Kind;
using Levels = std::vector<std::optional<std::size_t>>;

bool contains_sorted(const std::vector<Symbol>& sorted, Symbol symbol) {
  return std::ranges::binary_search(sorted, symbol);
}

void sort_unique(std::vector<Symbol>& symbols) {
  std::ranges::sort(symbols);
  symbols.erase(std::unique(symbols.begin(), symbols.end()), symbols.end());
}

// Inputs of the actors that have one of the outputs.
std::vector<Symbol> asking_by_actors(const InterfaceAutomaton& automaton, const Awaited& awaited) {
  std::vector<Symbol> asking;
  for (const Actor& actor : automaton.actors) {
    const bool has_output = std::ranges::any_of(awaited.outputs, [&](Symbol output) {
      const std::string& name = automaton.outputs().name(output);
      return std::ranges::find(actor.outputs, name) != actor.outputs.end();
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
    return std::ranges::any_of(events, [&](const ModelUse& event) {
      return event.kind == EdgeKind::take && event.model == awaited.model &&
             contains_sorted(awaited.outputs, event.index);
    });
  };
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      const auto next = program.edges_of(edge.target);
      const bool is_answered =
          takes(program, edge) ||
          std::ranges::any_of(next, [&](const auto& take) { return takes(program, take); });
      if (!is_answered) continue;
      for (const ModelUse& event : program.events_of(edge)) {
        if (event.kind == EdgeKind::give && event.model == awaited.model) {
          asking.push_back(event.index);
        }
      }
    }
  }
  return asking;
}

// Puts the outputs in order, and adds what asks for them.
void complete(const System& system, Awaited& awaited) {
  sort_unique(awaited.outputs);
  awaited.asking = asking_by_actors(system.models[awaited.model].automaton, awaited);
  if (awaited.asking.empty()) awaited.asking = asking_by_programs(system, awaited);
  sort_unique(awaited.asking);
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
    const auto next = std::ranges::find_if(transitions, [&](const auto& way) {
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
      std::ranges::adjacent_find(losses, [](const auto& one, const auto& next) {
        return one.step >= next.step || one.given > next.given || one.taken > next.taken;
      }) == losses.end();
  return is_ordered && std::ranges::all_of(losses, [&](const auto& loss) {
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

bool is_message_name(const std::string& output) {
  const std::string name = output.substr(0, output.find('('));
  return name == "message" || name == "next" || name == "gap";
}

std::optional<Awaited> find_awaited(const System& system, const Program& program,
                                    ControlState state) {
  Awaited awaited;
  for (const ProgramEdge& edge : program.edges_of(state)) {
    if (edge.kind != EdgeKind::take) continue;
    awaited.model = edge.model;
    awaited.outputs.push_back(edge.index);
  }
  if (awaited.outputs.empty()) return std::nullopt;
  complete(system, awaited);
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

namespace {

// All messages that the model has; none if it has none.
std::optional<Awaited> all_messages(const System& system, std::uint32_t model) {
  const InterfaceAutomaton& automaton = system.models[model].automaton;
  Awaited awaited;
  awaited.model = model;
  for (Symbol output = 0; output < automaton.outputs().size(); ++output) {
    if (is_message_name(automaton.outputs().name(output))) awaited.outputs.push_back(output);
  }
  if (awaited.outputs.empty()) return std::nullopt;
  complete(system, awaited);
  return awaited;
}

}  // namespace

std::optional<std::vector<Symbol>> find_held(const System& system, std::uint32_t model,
                                             StateId state) {
  const InterfaceAutomaton& automaton = system.models[model].automaton;
  const auto awaited = all_messages(system, model);
  if (!awaited) return std::nullopt;
  const Levels levels = count_obtainable(automaton, *awaited);
  if (!levels[state]) return std::nullopt;
  return outputs_from(automaton, *awaited, levels, state, *levels[state]);
}

std::vector<std::uint32_t> count_held(const System& system, std::uint32_t model) {
  const InterfaceAutomaton& automaton = system.models[model].automaton;
  std::vector<std::uint32_t> counts(automaton.size());
  const auto awaited = all_messages(system, model);
  if (!awaited) return counts;
  const Levels levels = count_obtainable(automaton, *awaited);
  for (StateId state = 0; state < automaton.size(); ++state) {
    counts[state] = static_cast<std::uint32_t>(levels[state].value_or(automaton.size() + 1));
  }
  return counts;
}

namespace {

// Whose message it is that arrives at the model in that step; none: it is no arrival, or that of a
// node, which may be several programs.
std::optional<std::uint32_t> sender_of(const System& system, std::uint32_t model,
                                       const Step& step) {
  if (doer_of(system, step) != nobody) return std::nullopt;
  for (const ModelUse& use : uses_of(system, step)) {
    const std::string& wire = system.models[use.model].name;
    if (!is_wire_to(wire, system.models[model].name)) continue;
    const std::string writer = wire.substr(system.models[model].name.size() + 2);
    const auto program = std::ranges::find(system.programs, writer, &Program::name);
    if (program == system.programs.end()) continue;
    return static_cast<std::uint32_t>(program - system.programs.begin());
  }
  return std::nullopt;
}

}  // namespace

std::optional<MessageAccount> take_account(const System& system, const Trace& trace,
                                           const std::vector<GlobalState>& states,
                                           const Awaited& awaited) {
  const InterfaceAutomaton& automaton = system.models[awaited.model].automaton;
  MAIDE_CHECK(states.size() == trace.steps.size() + 1);
  const Levels levels = count_obtainable(automaton, awaited);
  MessageAccount account;
  account.messages = find_messages(automaton, awaited, levels);
  if (account.messages.empty()) return std::nullopt;
  const bool has_wire = std::ranges::any_of(system.models, [&](const ModelInstance& model) {
    return is_wire_to(model.name, system.models[awaited.model].name);
  });
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    const auto uses = uses_of(system, step);
    if (std::ranges::none_of(uses,
                             [&](const ModelUse& use) { return use.model == awaited.model; })) {
      continue;
    }
    bool gives = false, takes = false, is_message = false;
    const std::optional<std::uint32_t> sender = sender_of(system, awaited.model, step);
    for (const ModelUse& event : sender ? uses : events_of(system, step)) {
      if (event.model != awaited.model) continue;
      // What lies on a wire is given when it arrives.
      if (event.kind == EdgeKind::give && has_wire && !sender) continue;
      gives = gives || event.kind == EdgeKind::give;
      takes = takes || event.kind == EdgeKind::take;
      is_message = is_message ||
                   (event.kind == EdgeKind::give && contains_sorted(account.messages, event.index));
    }
    const StateId before = states[at].models[awaited.model];
    const StateId after = states[at + 1].models[awaited.model];
    if (!levels[before] || !levels[after]) return std::nullopt;
    const std::size_t held = *levels[before], now = *levels[after];
    if (is_message) {
      ++account.given;
      if (sender || step.actor != nobody) account.givers.insert(sender.value_or(step.actor));
      if (now > held + 1) return std::nullopt;  // one input, several messages: not countable
      if (now == held + 1) continue;
      account.losses.push_back({at, account.given, account.taken, held, held + 1 - now,
                                which_was_lost(automaton, awaited, levels, before, after)});
    } else if (takes && now + 1 == held) {
      ++account.taken;
      if (step.actor != nobody) account.takers.insert(step.actor);
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

std::map<std::uint32_t, MessageAccount> find_losses(const System& system, const Trace& trace,
                                                    const std::vector<GlobalState>& states) {
  std::map<std::uint32_t, Awaited> taken;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& event : program.events_of(edge)) {
        if (event.kind != EdgeKind::take) continue;
        const Alphabet& outputs = system.models[event.model].automaton.outputs();
        if (!is_message_name(outputs.name(event.index))) continue;
        Awaited& awaited = taken[event.model];
        awaited.model = event.model;
        awaited.outputs.push_back(event.index);
      }
    }
  }
  std::map<std::uint32_t, MessageAccount> losses;
  for (auto& [model, awaited] : taken) {
    complete(system, awaited);
    auto account = take_account(system, trace, states, awaited);
    if (account && account->lost() > 0) losses.emplace(model, std::move(*account));
  }
  return losses;
}

}  // namespace maide
