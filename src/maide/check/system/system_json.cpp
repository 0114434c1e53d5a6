#include "maide/check/system/system_json.hpp"

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/ltl/ltl_automaton.hpp"

namespace maide {
namespace {

// The conversions are called by nlohmann::json, which hands on no argument of ours.
thread_local const RunControl* heard = nullptr;
thread_local std::uint32_t unheard = 0;

// As long as one lives, conversions on this thread hear of that control.
class Hearing {
 public:
  explicit Hearing(const RunControl& control) : before_(std::exchange(heard, &control)) {}
  ~Hearing() { heard = before_; }
  Hearing(const Hearing&) = delete;
  Hearing& operator=(const Hearing&) = delete;

 private:
  const RunControl* before_;
};

// Of each of what may be there by the million.
void hear() {
  constexpr std::uint32_t most_unheard = 4096;
  if (heard == nullptr || ++unheard < most_unheard) return;
  unheard = 0;
  heard->check("a dump");
}

}  // namespace
}  // namespace maide

// NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE, for conversions that may be stopped: what was made up to
// there is freed. (A constructor of the library that throws frees nothing.)
#define MAIDE_JSON_MEMBERS(Type, ...)                                                   \
  static void to_json(nlohmann::json& to, const Type& nlohmann_json_t) {                \
    nlohmann::json nlohmann_json_j;                                                     \
    NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_TO, __VA_ARGS__))            \
    to = std::move(nlohmann_json_j);                                                    \
  }                                                                                     \
  static void from_json(const nlohmann::json& nlohmann_json_j, Type& nlohmann_json_t) { \
    NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_FROM, __VA_ARGS__))          \
  }

namespace nlohmann {

template <typename Value>
struct adl_serializer<std::optional<Value>> {
  static void to_json(json& to, const std::optional<Value>& from) {
    maide::hear();
    if (from) {
      to = *from;
    } else {
      to = nullptr;
    }
  }
  static void from_json(const json& from, std::optional<Value>& to) {
    maide::hear();
    to = from.is_null() ? std::nullopt : std::optional<Value>(from.get<Value>());
  }
};

template <typename Value>
struct adl_serializer<std::shared_ptr<const Value>> {
  static void to_json(json& to, const std::shared_ptr<const Value>& from) {
    if (from) {
      to = *from;
    } else {
      to = nullptr;
    }
  }
  static void from_json(const json& from, std::shared_ptr<const Value>& to) {
    to = from.is_null() ? nullptr : std::make_shared<const Value>(from.get<Value>());
  }
};

}  // namespace nlohmann

namespace maide {

using nlohmann::json;

MAIDE_JSON_MEMBERS(SourcePosition, file, line, column)

// ---- Automata -----------------------------------------------------------------------------------

MAIDE_JSON_MEMBERS(Actor, name, inputs, outputs)

static void to_json(json& to, const InterfaceAutomaton& automaton) {
  json states = json::array();
  for (StateId state = 0; state < automaton.size(); ++state) {
    hear();
    json transitions = json::array();
    for (const InterfaceAutomaton::Transition& known : automaton.transitions(state)) {
      transitions.push_back({known.action.kind, known.action.symbol, known.target, known.absorbed});
    }
    const auto unexplored = automaton.unexplored(state);
    states.push_back({transitions, std::vector<Symbol>(unexplored.begin(), unexplored.end())});
  }
  to = {{"inputs", automaton.inputs().names()}, {"outputs", automaton.outputs().names()},
        {"initial", automaton.initial()},       {"origin", automaton.origin},
        {"actors", automaton.actors},           {"hidden_returns", automaton.hidden_returns}};
  to["states"] = std::move(states);
}

static void from_json(const json& from, InterfaceAutomaton& automaton) {
  const json& states = from.at("states");
  automaton = InterfaceAutomaton(Alphabet(from.at("inputs").get<std::vector<std::string>>()),
                                 Alphabet(from.at("outputs").get<std::vector<std::string>>()),
                                 states.size());
  automaton.set_initial(from.at("initial").get<StateId>());
  from.at("origin").get_to(automaton.origin);
  from.at("actors").get_to(automaton.actors);
  from.at("hidden_returns").get_to(automaton.hidden_returns);
  for (StateId state = 0; state < states.size(); ++state) {
    hear();
    for (const json& known : states[state].at(0)) {
      automaton.add_transition(state, {known.at(0).get<Action::Kind>(), known.at(1).get<Symbol>()},
                               known.at(2).get<StateId>(), known.at(3).get<bool>());
    }
    for (const json& input : states[state].at(1)) {
      automaton.mark_unexplored(state, input.get<Symbol>());
    }
  }
}

// ---- Values and expressions ---------------------------------------------------------------------

MAIDE_JSON_MEMBERS(ValueType, kind, low, high, words)
MAIDE_JSON_MEMBERS(Expression::Dimension, low, high)
MAIDE_JSON_MEMBERS(Expression, op, kind, value, owner, index, dimensions, operands, name, line,
                   column)

static void to_json(json& to, const WordTable& words) { to = words.names(); }
static void from_json(const json& from, WordTable& words) {
  words = WordTable();
  for (const json& word : from) words.intern(word.get<std::string>());
}

// ---- Programs -----------------------------------------------------------------------------------

static void to_json(json& to, const ModelUse& use) { to = {use.kind, use.model, use.index}; }
static void from_json(const json& from, ModelUse& use) {
  hear();
  use = {from.at(0).get<ModelUse::Kind>(), from.at(1).get<std::uint32_t>(),
         from.at(2).get<Symbol>()};
}

static void to_json(json& to, const ModelStep& step) {
  hear();
  to = {step.target, step.is_beyond};
}
static void from_json(const json& from, ModelStep& step) {
  hear();
  step = {from.at(0).get<StateId>(), from.at(1).get<bool>()};
}

static void to_json(json& to, const ProgramEdge& edge) {
  hear();
  to = {edge.kind, edge.model, edge.index, edge.target, edge.line, edge.column, edge.origin};
}
static void from_json(const json& from, ProgramEdge& edge) {
  from_json(from, static_cast<ModelUse&>(edge));
  edge.target = from.at(3).get<ControlState>();
  edge.line = from.at(4).get<int>();
  edge.column = from.at(5).get<int>();
  edge.origin = from.at(6).get<std::uint32_t>();
}

static void to_json(json& to, const Program::State& state) {
  hear();
  to = {state.first_edge, state.edge_count, state.label_set, state.round,  state.valuation,
        state.error,      state.may_rest,   state.waits,     state.is_over};
}
static void from_json(const json& from, Program::State& state) {
  hear();
  const auto number = [&](std::size_t place) { return from.at(place).get<std::uint32_t>(); };
  state = {number(0),
           number(1),
           number(2),
           number(3),
           number(4),
           number(5),
           from.at(6).get<bool>(),
           from.at(7).get<bool>(),
           from.at(8).get<bool>()};
}

MAIDE_JSON_MEMBERS(CombinedStep, role, uses, events, text, fair, callback, awaits_anybody)
MAIDE_JSON_MEMBERS(ActorFlags, counts_for_deadlock, is_fair, may_rest, is_shown, counts_on_anybody)
MAIDE_JSON_MEMBERS(FairGroup, on_weak_runs, text)
MAIDE_JSON_MEMBERS(ProgramVariable, name, type, position)
MAIDE_JSON_MEMBERS(ProgramError, text, position)
MAIDE_JSON_MEMBERS(Program::Round, outer, line, column, number, count)
MAIDE_JSON_MEMBERS(Program::CallbackLines, name, first, last)
MAIDE_JSON_MEMBERS(Program::Guard, text, line, column, variables)
MAIDE_JSON_MEMBERS(Program::Select, state, guards)
MAIDE_JSON_MEMBERS(ProgramLife, model, is_dead, is_dead_for_good, first_values)
MAIDE_JSON_MEMBERS(Program, name, flags, nodes, execution, life, callbacks, position, last_line,
                   states, edges, labels, label_sets, rounds, unreachable, combined, fair_groups,
                   variables, valuations, errors, selects, guard_lists, origins, names, spins_until)

// ---- Properties ---------------------------------------------------------------------------------

MAIDE_JSON_MEMBERS(Atom, kind, owner, symbol, program)
MAIDE_JSON_MEMBERS(FormulaNode, op, atom, left, right)
MAIDE_JSON_MEMBERS(Letter, positive, negative)
MAIDE_JSON_MEMBERS(LtlAutomaton::Transition, letter, target, marks)
MAIDE_JSON_MEMBERS(LtlAutomaton, atoms, mark_count, states, initial, universal)
MAIDE_JSON_MEMBERS(Property, name, kind, formula, is_possibility, is_always_possible, never,
                   fairness, position)

// ---- The system ---------------------------------------------------------------------------------

MAIDE_JSON_MEMBERS(ModelAction, name, steps, is_call)
MAIDE_JSON_MEMBERS(ServiceContents, requests, served, answers, sent, coming)
MAIDE_JSON_MEMBERS(ModelInstance, name, automaton, actions, source, type, is_grown, state_texts,
                   held, service_contents, when_unexplored, when_weak, origin, as_read,
                   awaits_anybody, is_learned, position)
MAIDE_JSON_MEMBERS(NobodysAction, what, counts_for_deadlock, is_shown, lost, position, origin)
MAIDE_JSON_MEMBERS(TopicInstance::Reader, program, model, callback, collected)
MAIDE_JSON_MEMBERS(TopicInstance, name, writer_names, writers, readers, delivers_one, meets)
MAIDE_JSON_MEMBERS(ServiceInstance, name, server, clients, model)
MAIDE_JSON_MEMBERS(ConnectionInstance, name, is_late, loses, why)
MAIDE_JSON_MEMBERS(ExecutorInstance, name, threads, goes_by_rounds)
MAIDE_JSON_MEMBERS(CallbackInstance, kind, node, name, executor, group, is_reentrant, model)

MAIDE_JSON_MEMBERS(ConstantSetting, name, value)
MAIDE_JSON_MEMBERS(System, file, settings, models, topics, services, connections, executors,
                   callbacks, programs, nobodys_actions, nobodys_groups, properties, remarks, holes,
                   open_ends, expressions, words, sources)

json json_of(const System& system, const RunControl& control) {
  const Hearing hearing(control);
  return system;
}
json json_of(const InterfaceAutomaton& automaton, const RunControl& control) {
  const Hearing hearing(control);
  return automaton;
}
System system_of(const json& from, const RunControl& control) {
  const Hearing hearing(control);
  return from.get<System>();
}
InterfaceAutomaton automaton_of(const json& from, const RunControl& control) {
  const Hearing hearing(control);
  return from.get<InterfaceAutomaton>();
}

}  // namespace maide
