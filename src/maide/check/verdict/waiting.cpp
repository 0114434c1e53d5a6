#include "maide/check/verdict/waiting.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/check/rules/model_words.hpp"

namespace maide {
namespace {

using EdgeKind = ProgramEdge::Kind;
using Reason = Waiting::Reason;
using Helps = std::function<bool(const Program&, const ProgramEdge&)>;

// Symbols, and other numbers.
bool contains(const std::vector<std::uint32_t>& numbers, std::uint32_t number) {
  return std::ranges::find(numbers, number) != numbers.end();
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
    if (std::ranges::find(actor.inputs, name) == actor.inputs.end()) continue;
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
    waiting_.awaited = awaited_at(own(), state_.programs[program]);
    const auto& awaited = waiting_.awaited;
    const bool is_plain = std::ranges::all_of(awaited, [&](const auto& edge) {
      return (edge.kind == EdgeKind::give || edge.kind == EdgeKind::take ||
              edge.kind == EdgeKind::quiet) &&
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
      find_ways();
      MAIDE_CHECK(is_consistent());
      return std::move(waiting_);
    }
    waiting_.due = outputs_due(automaton(), state_.models[waiting_.model]);
    const ProgramEdge& first = waiting_.awaited.front();
    if (!waiting_.due.empty()) {
      explain_due();
    } else if (first.kind != EdgeKind::give) {
      explain_silence();
    } else if (is_beyond_learned(automaton(), state_.models[waiting_.model], first.index)) {
      waiting_.reason = Reason::bound;
      waiting_.wanted = other_inputs(automaton(), same_actor(automaton(), first.index));
    } else {
      explain_refusal(first.index);
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
           !contains(helpers, waiting.program) && waiting.round <= waiting.rounds;
  }

  const Program& own() const { return system_.programs[waiting_.program]; }
  const InterfaceAutomaton& automaton() const { return system_.models[waiting_.model].automaton; }

  // The last step before `at_` with the model that `is_it` accepts.
  std::optional<std::size_t> last_step(const std::function<bool(std::size_t)>& is_it) const {
    for (std::size_t step = at_; step-- > 0;) {
      const auto uses = uses_of(system_, trace_.steps[step]);
      const bool is_of_model = std::ranges::any_of(
          uses, [&](const ModelUse& use) { return use.model == waiting_.model; });
      if (is_of_model && is_it(step)) return step;
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
      const auto events = events_of(system_, trace_.steps[step]);
      return std::ranges::any_of(events, [&](const ModelUse& event) {
        return event.kind == EdgeKind::give && event.model == waiting_.model &&
               contains(actor, event.index);
      });
    });
    waiting_.wanted = other_inputs(automaton(), actor);
  }

  void find_helpers() {
    const EdgeKind kind = waiting_.reason == Reason::output_due ? EdgeKind::take : EdgeKind::give;
    add_helpers([&](const Program& program, const ProgramEdge& edge) {
      const auto events = program.events_of(edge);
      return std::ranges::any_of(events, [&](const ModelUse& event) {
        return event.kind == kind && event.model == waiting_.model &&
               contains(waiting_.wanted, event.index);
      });
    });
  }

  void find_ways() {
    waiting_.ways = find_ways_out(system_, state_, waiting_.program);
    std::set<std::uint32_t> helpers, reachable;
    for (const WayOut& way : waiting_.ways) {
      for (const Helper& helper : way.helpers) {
        if (helper.program == waiting_.program) continue;
        helpers.insert(helper.program);
        if (helper.obstacle == Obstacle::none) reachable.insert(helper.program);
      }
    }
    waiting_.helpers.assign(helpers.begin(), helpers.end());
    waiting_.reachable_helpers.assign(reachable.begin(), reachable.end());
    find_services();
  }

  // The answers that are awaited, each of a service once.
  void find_services() {
    std::set<std::uint32_t> known;
    for (const ProgramEdge& edge : waiting_.awaited) {
      for (const ModelUse& event : own().events_of(edge)) {
        const ServiceInstance* const service = find_service(system_, event.model);
        if (service == nullptr || event.kind != EdgeKind::take) continue;
        const Alphabet& outputs = system_.models[event.model].automaton.outputs();
        if (!is_numbered(outputs.name(event.index), "answer")) continue;
        const auto client = own_client(*service);
        if (client && known.insert(event.model).second) add_service(*service, *client);
      }
    }
  }

  // The program's name, or that of the node whose code it runs.
  std::string own_name() const {
    const auto callback = running_callback(system_, state_, waiting_.program);
    if (callback) return system_.callbacks[*callback].node;
    return own().nodes.size() == 1 ? own().nodes.front() : own().name;
  }

  // The one that the program is. In the start of a node, or in what spins: that of the first of its
  // nodes that is one.
  std::optional<std::uint32_t> own_client(const ServiceInstance& service) const {
    if (const auto client = client_named(service, own_name())) return client;
    for (const std::string& node : own().nodes) {
      if (const auto client = client_named(service, node)) return client;
    }
    return std::nullopt;
  }

  void add_service(const ServiceInstance& service, std::uint32_t client) {
    const std::uint32_t model = service.model;
    const auto& contents = system_.models[model].service_contents;
    if (contents.empty()) return;
    const ServiceContents& held = contents[state_.models[model]];
    ServiceWait wait;
    wait.model = model;
    wait.client = client;
    wait.is_requested = contains(held.requests, client) || held.sent[client] > 0;
    wait.is_served = contains(held.served, client);
    wait.is_coming = held.coming[client] > 0;
    wait.is_answered = held.answers[client] > 0;
    const auto asked = last_request(model, client);
    wait.has_asked = asked.has_value();
    const bool is_on_its_way =
        wait.is_requested || wait.is_served || wait.is_coming || wait.is_answered;
    if (!is_on_its_way && asked) wait.loss = last_loss(model, client, *asked);
    const std::string& node = service.clients[client];
    for (std::uint32_t number = 0; number < system_.callbacks.size(); ++number) {
      const CallbackInstance& callback = system_.callbacks[number];
      if (callback.model != model) continue;
      if (callback.kind == CallbackKind::client && callback.node == node) {
        wait.taker = find_starter(system_, state_, waiting_.program, number);
      }
      if (callback.kind == CallbackKind::service) {
        wait.server = find_starter(system_, state_, waiting_.program, number);
      }
    }
    if (!wait.server) wait.server = serving_program(service);
    waiting_.services.push_back(std::move(wait));
  }

  std::optional<Helper> serving_program(const ServiceInstance& service) const {
    const auto place = std::ranges::find(system_.programs, service.server, &Program::name);
    if (place == system_.programs.end()) return std::nullopt;
    Helper server;
    server.program = static_cast<std::uint32_t>(place - system_.programs.begin());
    if (place->is_end(state_.programs[server.program])) server.obstacle = Obstacle::ended;
    return server;
  }

  // The step in which the client asked last.
  std::optional<std::size_t> last_request(std::uint32_t model, std::uint32_t client) const {
    const auto send = system_.models[model].automaton.inputs().find(name_at_client("send", client));
    for (std::size_t step = at_; send && step-- > 0;) {
      const auto events = events_of(system_, trace_.steps[step]);
      const ModelUse sends{EdgeKind::give, model, *send};
      if (std::ranges::find(events, sends) != events.end()) return step;
    }
    return std::nullopt;
  }

  std::optional<ServiceLoss> last_loss(std::uint32_t model, std::uint32_t client,
                                       std::size_t since) const {
    const Trace so_far{{trace_.steps.begin(), trace_.steps.begin() + static_cast<long>(at_)}, {}};
    const std::vector<GlobalState> states(states_.begin(),
                                          states_.begin() + static_cast<long>(at_) + 1);
    std::optional<ServiceLoss> last;
    for (const ServiceLoss& loss : find_service_losses(system_, so_far, states, model)) {
      if (loss.client == client && loss.step > since) last = loss;
    }
    return last;
  }

  void add_helpers(const Helps& helps) {
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      const Program& program = system_.programs[index];
      if (index == waiting_.program) continue;
      if (std::ranges::none_of(program.edges,
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
    return std::ranges::any_of(waiting_.awaited, [&](const auto& other) {
      return edge.kind == other.kind && edge.model == other.model && edge.index == other.index;
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
      if (trace_.steps[step].actor != waiting_.program) continue;
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
        if (!program.is_progress(edge)) continue;
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
    if (step.actor != nobody && is_progress(system, step)) can_step[step.actor] = true;
  }
  std::vector<std::uint32_t> blocked;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const Program::State& at = program.states[state.programs[index]];
    if (!can_step[index] && (at.edge_count > 0 || at.waits) && at.error == 0 &&
        !program.may_rest(state.programs[index])) {
      blocked.push_back(index);
    }
  }
  return blocked;
}

std::vector<std::uint32_t> find_circle(const std::vector<Waiting>& waitings) {
  std::vector<std::uint32_t> path;
  if (waitings.empty()) return path;
  for (std::uint32_t program = waitings.front().program;;) {
    const auto waiting = std::ranges::find(waitings, program, &Waiting::program);
    if (waiting == waitings.end() || waiting->reachable_helpers.size() != 1) return {};
    path.push_back(program);
    MAIDE_CHECK(path.size() <= waitings.size());
    program = waiting->reachable_helpers.front();
    if (program == path.front()) return path;
    if (contains(path, program)) return {};
  }
}

}  // namespace maide
