#include "maide/check/build/wires.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/deliveries.hpp"
#include "maide/check/rules/stream.hpp"
#include "maide/check/rules/wire.hpp"

namespace maide {
namespace {

using Kind = WireModel::Operation::Kind;
using Room = std::vector<std::optional<std::uint32_t>>;

constexpr std::size_t most_states = 20'000;  // of a wire whose states are made at once

std::string base_of(const std::string& name) { return name.substr(0, name.find('(')); }

std::vector<Symbol> letters_of(const InterfaceAutomaton& automaton) {
  std::vector<Symbol> letters;
  for (Symbol input = 0; input < automaton.inputs().size(); ++input) {
    if (is_sending(automaton.inputs().name(input))) letters.push_back(input);
  }
  return letters;
}

// The other inputs of the actors that have these, and those that end the connection.
std::vector<Symbol> others_of(const InterfaceAutomaton& automaton,
                              const std::vector<Symbol>& letters) {
  const Alphabet& inputs = automaton.inputs();
  std::vector<Symbol> others;
  for (Symbol input = 0; input < inputs.size(); ++input) {
    const std::string name = base_of(inputs.name(input));
    if (name == "disconnect" || name == "close") others.push_back(input);
  }
  for (const Actor& actor : automaton.actors) {
    const auto has = [&](Symbol input) {
      return std::ranges::find(actor.inputs, inputs.name(input)) != actor.inputs.end();
    };
    if (std::ranges::none_of(letters, has)) continue;
    for (Symbol input = 0; input < inputs.size(); ++input) {
      const bool is_known = std::ranges::find(others, input) != others.end();
      if (has(input) && !is_sending(inputs.name(input)) && !is_known) others.push_back(input);
    }
  }
  return others;
}

// Whoever gives one of these inputs may wait for an output.
bool has_returns(const InterfaceAutomaton& automaton, const std::vector<Symbol>& letters) {
  if (automaton.actors.empty()) return false;
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (!automaton.is_quiescent(state)) continue;
    for (const auto& given : automaton.transitions(state)) {
      if (!given.action.is_input() ||
          std::ranges::find(letters, given.action.symbol) == letters.end()) {
        continue;
      }
      for (const auto& next : automaton.transitions(given.target)) {
        if (!next.action.is_input() &&
            is_of_same_actor(automaton, given.action.symbol, next.action.symbol)) {
          return true;
        }
      }
    }
  }
  return false;
}

// By state: after how many of these inputs the model refuses one, at least; none: never. What is
// due is taken first. O(transitions).
Room room_of(const ModelInstance& model, const std::vector<Symbol>& letters) {
  const InterfaceAutomaton& automaton = model.automaton;
  struct Before {
    StateId state = 0;
    std::uint32_t cost = 0;
  };
  std::vector<std::vector<Before>> before(automaton.size());
  Room room(automaton.size());
  std::deque<StateId> open;
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (!automaton.is_quiescent(state)) {
      for (const auto& due : automaton.transitions(state)) {
        if (!due.action.is_input()) before[due.target].push_back({state, 0});
      }
      continue;
    }
    for (const Symbol letter : letters) {
      const auto steps = model_steps(model, state, {ModelUse::Kind::give, 0, letter});
      for (const ModelStep& step : steps) before[step.target].push_back({state, 1});
      if (!steps.empty() || room[state]) continue;
      room[state] = 0;
      open.push_back(state);
    }
  }
  while (!open.empty()) {
    const StateId state = open.front();
    open.pop_front();
    for (const auto& [earlier, cost] : before[state]) {
      const std::uint32_t less = *room[state] + cost;
      if (room[earlier] && *room[earlier] <= less) continue;
      room[earlier] = less;
      if (cost == 0) {
        open.push_front(earlier);
      } else {
        open.push_back(earlier);
      }
    }
  }
  return room;
}

// What of the service's is on its way for a while: a client, and whether it is its requests.
struct ServiceWay {
  std::uint32_t client = 0;
  bool is_request = false;
};
std::vector<ServiceWay> ways_of(const Service& service) {
  const ServiceShape& shape = service.rules->shape();
  std::vector<ServiceWay> ways;
  for (std::uint32_t client = 0; client < shape.is_late.size(); ++client) {
    if (shape.is_late[client]) ways.push_back({client, true});
    if (shape.is_late[client] || shape.callers > 0) ways.push_back({client, false});
  }
  return ways;
}

class WireMaker {
 public:
  WireMaker(const Declarations& file, Models& models) : file_(file), models_(models) {}

  std::vector<ConnectionInstance> make() {
    if (file_.is_at_rest) return {};
    for (const Topic& topic : models_.names.topics) add_topic(topic);
    const auto writers = writers_of_models();
    for (const auto& [model, ends] : writers) add_model(model, ends);
    std::uint32_t group = 0;
    for (auto& [to, wires] : models_.names.wires) {
      add_counter(to, wires);
      for (Wire& wire : wires) wire.group = ++group;
    }
    for (auto& [model, service] : models_.names.services) {
      service.group = group + 1;
      note_streams(model, service);
      group += static_cast<std::uint32_t>(ways_of(service).size());
    }
    for (const auto& [stream, wires] : streams_) {
      if (wires.size() > 1) add_stream(stream, wires);
    }
    for (const auto& [model, service] : models_.names.services) {
      connections_.push_back(connection_of_service(model, service));
    }
    return std::move(connections_);
  }

 private:
  const std::string& process_of_program(std::uint32_t program) const {
    return file_.programs[program].process;
  }
  std::string name_of(const End& end) const {
    return end.node.empty() ? file_.programs[end.program].name : end.node;
  }

  void add_topic(const Topic& topic) {
    std::vector<End> ends;
    for (const std::uint32_t writer : topic.writers) {
      if (file_.programs[writer].nodes.empty()) ends.push_back({writer, ""});
    }
    for (const std::string& node : topic.writer_nodes) ends.push_back({0, node});
    ConnectionInstance connection{topic.name, false, false, ""};
    const bool has_returns = std::ranges::any_of(topic.readers, &Topic::Reader::has_returns);
    const bool has_farewell = std::ranges::any_of(
        topic.readers, [](const Topic::Reader& reader) { return !reader.writer_death.empty(); });
    for (const Topic::Reader& reader : topic.readers) {
      for (const End& end : ends) {
        DeliveryPlace place;
        place.is_topic = true;
        place.is_in_one_process = process_of_end(file_, end) == process_of_program(reader.program);
        const DeliveryRule rule =
            delivery_of(models_.instances[reader.model], file_.origins[reader.model],
                        file_.deliveries.at(reader.model), place);
        if (connection.why.empty()) connection.why = rule.why;
        if (rule.delivery == Delivery::at_once) continue;
        if (rule.delivery == Delivery::acknowledged && topic.readers.size() == 1) continue;
        if (has_returns || has_farewell) {
          connection.why = has_returns ? "its writer waits for what its calls return"
                                       : "its readers notice the death of a writer";
          continue;
        }
        const bool is_acknowledged = rule.delivery == Delivery::acknowledged;
        const auto callers =
            is_acknowledged ? programs_at(file_, end) : std::vector<std::uint32_t>();
        if (!is_wished(reader.model) &&
            has_too_many_states(reader.model, rule.wire, callers.size())) {
          connection.why = too_many_states;
          continue;
        }
        connection.is_late = true;
        connection.loses = connection.loses || rule.wire.loses;
        add_wire(reader.model, {end, {}}, rule, callers);
        note_stream(reader.model, rule, end, process_of_program(reader.program));
      }
    }
    connections_.push_back(std::move(connection));
  }

  // Who gives inputs to a model, and which: names without values.
  struct Writer {
    End end;
    std::set<std::string> inputs;
  };

  void add_model(std::uint32_t number, const std::vector<Writer>& writers) {
    const ModelInstance& model = models_.instances[number];  // until there is a wire
    DeliveryPlace place;
    place.is_in_one_process = std::ranges::all_of(users_[number], [&](std::uint32_t program) {
      return process_of_program(program) == process_of_program(*users_[number].begin());
    });
    const DeliveryRule rule =
        delivery_of(model, file_.origins[number], file_.deliveries.at(number), place);
    ConnectionInstance connection{model.name, rule.delivery == Delivery::late, rule.wire.loses,
                                  rule.why};
    const bool is_large = model.is_grown && !file_.origins[number].size.drops_oldest;
    if (connection.is_late &&
        (is_large || has_returns(model.automaton, letters_of(model.automaton)))) {
      connection.is_late = false;
      connection.why = is_large ? "it is a queue of too many states"
                                : "its writer waits for what its calls return";
    }
    if (connection.is_late && !is_wished(number) && has_too_many_states(number, rule.wire)) {
      connection.is_late = false;
      connection.why = too_many_states;
    }
    // Of what is written by hand that is said, and that is enough.
    const bool is_by_hand = model.source == ModelInstance::Source::built_in;
    if (connection.is_late) {
      for (const Writer& writer : writers) {
        if (add_wire(number, writer, rule)) note_stream(number, rule, writer.end, "");
      }
    }
    if (connection.is_late || !is_by_hand || !connection.why.empty()) {
      connections_.push_back(std::move(connection));
    }
  }

  ConnectionInstance connection_of_service(std::uint32_t model, const Service& service) const {
    const bool is_late = !ways_of(service).empty();
    DeliveryPlace place;
    place.is_in_one_process = !is_late;
    place.is_of_ros2 = true;
    const DeliveryRule rule = delivery_of(service, file_.deliveries.at(model), place);
    return {service.name, is_late, rule.wire.loses, rule.why};
  }

  bool is_wished(std::uint32_t model) const {
    return file_.deliveries.at(model).delivery.has_value();
  }
  // What lies on a wire is a word over all that may be sent.
  bool has_too_many_states(std::uint32_t to, const WireRules& rules,
                           std::size_t callers = 0) const {
    const auto letters = static_cast<double>(letters_of(models_.instances[to].automaton).size());
    const std::size_t most = callers == 0 ? rules.room() : callers;
    double words = 1, longest = 1;
    for (std::size_t length = 0; length < most && words <= most_states; ++length) {
      longest *= letters;
      if (callers > 0) longest *= static_cast<double>(callers - length);
      words += longest;
    }
    return words > most_states;
  }
  static constexpr std::uint32_t most_clients_in_a_stream = 8;  // its answers have 2^n ways
  static constexpr const char* too_many_states =
      "with so many values on its way it would have too many states; `delivery: late` tries";

  // The wire that was added last.
  void note_stream(std::uint32_t to, const DeliveryRule& rule, const End& from,
                   const std::string& process) {
    if (rule.stream.empty()) return;
    const std::size_t wire = models_.names.wires.at(to).size() - 1;
    const std::string name = models_.instances[models_.names.wires.at(to)[wire].model].name;
    streams_[{rule.stream, process_of_end(file_, from), process}].push_back(
        {name, to,
         [this, to, wire]() -> PlaceInStream& { return models_.names.wires.at(to)[wire].place; }});
  }

  void note_streams(std::uint32_t model, Service& service) {
    const std::string& stream = file_.deliveries.at(model).stream;
    const auto clients = static_cast<std::uint32_t>(service.clients.size());
    service.requests_in.resize(clients);
    service.answers_in.resize(clients);
    if (stream.empty()) return;
    if (clients > most_clients_in_a_stream) {
      throw ParseError(
          fmt::format("a service with `stream` has at most {} clients: an answer comes to "
                      "all, and each may lose another one by it",
                      most_clients_in_a_stream),
          models_.instances[model].position);
    }
    for (const auto& [client, is_request] : ways_of(service)) {
      std::string client_process = process_of_end(file_, service.clients[client]);
      std::string server_process = process_of_end(file_, service.server);
      if (is_request) std::swap(client_process, server_process);
      const std::string& name = service.rules->shape().names[client];
      streams_[{stream, server_process, client_process}].push_back(
          {(is_request ? "requests of " + name + " to " + service.name
                       : "answers of " + service.name + " to " + name),
           model, [&service, client = client, is_request = is_request]() -> PlaceInStream& {
             return is_request ? service.requests_in[client] : service.answers_in[client];
           }});
    }
  }

  struct Member {
    std::string name;
    std::uint32_t model = 0;
    std::function<PlaceInStream&()> place;
  };
  using Members = std::vector<Member>;
  void add_stream(const std::array<std::string, 3>& stream, const Members& members) {
    std::vector<std::string> names;
    for (const Member& member : members) names.push_back(member.name);
    const std::uint32_t model = number_of_next();
    const auto order = std::make_shared<StreamModel>(names);
    for (std::uint32_t number = 0; number < members.size(); ++number) {
      members[number].place() = {order, model, number};
    }
    ModelInstance instance =
        make_instance("stream " + stream[0] + " of " + join(names), members.front().model);
    instance.automaton = order->start();
    instance.is_grown = true;
    models_.growing.emplace(model, order);
    models_.instances.push_back(std::move(instance));
  }

  // Without names of inputs all those lie on it that are sent. False: there are none.
  bool add_wire(std::uint32_t to, const Writer& writer, const DeliveryRule& rule,
                const std::vector<std::uint32_t>& callers = {}) {
    const WireRules& rules = rule.wire;
    Wire wire;
    wire.model = number_of_next();
    wire.to = to;
    wire.from = writer.end;
    wire.writer = name_of(writer.end);
    const Alphabet& inputs = models_.instances[to].automaton.inputs();
    std::vector<std::string> names;
    for (const Symbol letter : letters_of(models_.instances[to].automaton)) {
      const std::string& name = inputs.name(letter);
      if (!writer.inputs.empty() && !writer.inputs.contains(base_of(name))) continue;
      wire.letters.push_back(letter);
      names.push_back(name);
    }
    if (names.empty()) return false;
    wire.others = others_of(models_.instances[to].automaton, wire.letters);
    const bool may_die = writer.end.node.empty() && file_.programs[writer.end.program].may_die;
    wire.callers = callers;
    const auto caller_count = static_cast<std::uint32_t>(callers.size());
    wire.rules = std::make_shared<WireModel>(rules, names, caller_count);
    ModelInstance instance = make_instance(wire_name(models_.instances[to].name, wire.writer), to);
    instance.automaton = wire.rules->start();
    if (wire.rules->make_all(instance.automaton, may_die, most_states)) {
      for (StateId state = 0; state < instance.automaton.size(); ++state) {
        instance.state_texts.push_back(wire.rules->describe(state));
        instance.held.push_back(wire.rules->held(state).value());
      }
    } else {
      wire.rules = std::make_shared<WireModel>(rules, std::move(names), caller_count);
      instance.automaton = wire.rules->start();
      instance.is_grown = true;
      models_.growing.emplace(wire.model, wire.rules);
    }
    rooms_[to] += rules.room();
    models_.instances.push_back(std::move(instance));
    models_.names.wires[to].push_back(std::move(wire));
    return true;
  }

  // Where the model may refuse what is written. What is on its wires is at most what it has room
  // for, where that is bounded, and what the wires hold.
  void add_counter(std::uint32_t to, std::vector<Wire>& wires) {
    const ModelInstance& model = models_.instances[to];
    if (model.is_grown) return;  // it drops the oldest
    Room room = room_of(model, letters_of(model.automaton));
    if (std::ranges::none_of(room, [](const auto& at) { return at.has_value(); })) return;
    std::size_t most = 0;
    for (const auto& at : room) most = std::max<std::size_t>(most, at.value_or(rooms_[to]));
    most = std::min(most, rooms_[to]);
    const auto shared = std::make_shared<const Room>(std::move(room));
    for (Wire& wire : wires) {
      wire.room = shared;
      wire.counter = number_of_next();
    }
    ModelInstance counter = make_instance(wire_name(model.name, ""), to);
    counter.automaton = InterfaceAutomaton({}, {}, most + 1);
    counter.state_texts.resize(most + 1);
    models_.instances.push_back(std::move(counter));
  }

  ModelInstance make_instance(std::string name, std::uint32_t to) const {
    ModelInstance instance;
    instance.name = std::move(name);
    instance.source = ModelInstance::Source::wire;
    instance.position = models_.instances[to].position;
    return instance;
  }

  std::uint32_t number_of_next() const {
    if (models_.instances.size() >= max_components) {
      throw ParseError(
          "there are more than " + std::to_string(max_components) + " models and ways to them",
          {file_.tree().file(), 0, 0});
    }
    return static_cast<std::uint32_t>(models_.instances.size());
  }

  // ---- Models that are no topic's
  // -----------------------------------------------------------------

  // Who gives them inputs, by model.
  std::map<std::uint32_t, std::vector<Writer>> writers_of_models() {
    std::map<std::uint32_t, std::vector<Writer>> writers;
    for (std::uint32_t number = 0; number < file_.programs.size(); ++number) {
      const program_syntax::Tree tree =
          resolve(file_.programs[number], models_.context(file_, number));
      for (const std::uint32_t model : tree.names) users_[model].insert(number);
      visit(tree.statements, [&](const program_syntax::ModelReference& reference,
                                 const program_syntax::Event& event,
                                 const program_syntax::Callback* callback,
                                 const program_syntax::SelectArm* arm) {
        if (arm != nullptr) refuse_call(number, *arm, callback);
        if (reference.is_topic || !is_sending(event.name) || reference.known == nullptr) return;
        const End end{callback == nullptr ? number : 0, callback == nullptr ? "" : callback->node};
        const auto count = static_cast<std::uint32_t>(member_count(reference.known->dimensions));
        for (std::uint32_t member = 0; member < count; ++member) {
          const std::uint32_t model = reference.known->first + member;
          if (models_.names.services.contains(model) || !file_.deliveries.contains(model)) continue;
          auto& ends = writers[model];
          auto known = std::ranges::find_if(
              ends, [&](const Writer& other) { return other.end.is_of(end.node, end.program); });
          if (known == ends.end()) known = ends.insert(known, {end, {}});
          known->inputs.insert(event.name);
        }
      });
    }
    return writers;
  }

  // An arm is taken in one step, and a call that returns later is two.
  void refuse_call(std::uint32_t number, const program_syntax::SelectArm& arm,
                   const program_syntax::Callback* callback) const {
    const ModelName* const known = arm.model.known;
    if (known == nullptr || !is_sending(arm.event.name)) return;
    const auto count = static_cast<std::uint32_t>(member_count(known->dimensions));
    const std::string node = callback == nullptr ? "" : callback->node;
    for (std::uint32_t member = known->first; member < known->first + count; ++member) {
      if (!calls(arm, member, node, number)) continue;
      throw ParseError("no arm can be '" + arm.model.name() + "." + arm.event.name +
                           "': it returns when all readers have the message (delivery: "
                           "acknowledged)",
                       {file_.programs[number].position.file, arm.line, arm.column});
    }
  }
  // What that code gives there returns later.
  bool calls(const program_syntax::SelectArm& arm, std::uint32_t number, const std::string& node,
             std::uint32_t program) const {
    const Names& names = models_.names;
    if (!arm.model.is_topic) {
      const auto service = names.services.find(number);
      return service != names.services.end() && arm.event.name == "answer" &&
             !service->second.callers.empty();
    }
    return std::ranges::any_of(names.topics[number].readers, [&](const Topic::Reader& reader) {
      const Wire* const wire = names.wire_of(reader.model, node, program);
      return wire != nullptr && !wire->callers.empty();
    });
  }

  // The arm is null where it is a statement.
  using Visit =
      std::function<void(const program_syntax::ModelReference&, const program_syntax::Event&,
                         const program_syntax::Callback*, const program_syntax::SelectArm*)>;
  static void visit(const program_syntax::Block& block, const Visit& each) {
    for (const program_syntax::Statement& statement : block.statements) {
      if (statement.kind == program_syntax::Statement::Kind::give) {
        each(statement.model, statement.input, statement.callback, nullptr);
      }
      for (const program_syntax::Arm& arm : statement.arms) visit(*arm.body, each);
      for (const program_syntax::SelectArm& arm : statement.select_arms) {
        if (arm.kind == program_syntax::SelectArm::Kind::input) {
          each(arm.model, arm.event, arm.starts != nullptr ? arm.starts : arm.callback, &arm);
        }
        for (const program_syntax::Arm& inner : arm.arms) visit(*inner.body, each);
        if (arm.body) visit(*arm.body, each);
        if (arm.end) visit(*arm.end, each);
      }
      if (statement.body) visit(*statement.body, each);
      if (statement.otherwise) visit(*statement.otherwise, each);
    }
  }

  const Declarations& file_;
  Models& models_;
  std::map<std::uint32_t, std::set<std::uint32_t>> users_;  // by model: programs that name it
  std::map<std::uint32_t, std::size_t> rooms_;              // by model: of all wires to it
  // By stream and the processes of both ends; no process of a model that stands by itself.
  std::map<std::array<std::string, 3>, Members> streams_;
  std::vector<ConnectionInstance> connections_;
};

}  // namespace

// ---- Uses of wires ------------------------------------------------------------------------------

std::uint32_t most_counted(const Wire& wire, const ModelActions& actions) {
  return static_cast<std::uint32_t>(actions.model(*wire.counter).automaton.size() - 1);
}

bool has_room_for(const Wire& wire, StateId state, std::uint32_t needed) {
  const auto& room = (*wire.room)[state];
  return !room || *room >= needed;
}

namespace {

std::uint32_t caller_of(const Wire& wire, std::uint32_t program) {
  if (wire.callers.empty()) return 0;
  const auto place = std::ranges::find(wire.callers, program);
  MAIDE_CHECK(place != wire.callers.end());
  return static_cast<std::uint32_t>(place - wire.callers.begin());
}
std::uint32_t letter_of(const Wire& wire, Symbol input, std::uint32_t program) {
  const auto place = std::ranges::find(wire.letters, input) - wire.letters.begin();
  return wire.rules->letter_of(static_cast<std::uint32_t>(place), caller_of(wire, program));
}

ModelUse use(const Wire& wire, ModelActions& actions, Kind kind, std::uint32_t letter = 0) {
  return wire.rules->use(actions, wire.model, {kind, letter});
}

// The counter is at `from`, and afterwards at `to`.
ModelUse count(const Wire& wire, ModelActions& actions, std::uint32_t from, std::uint32_t to) {
  const std::string name = from == to ? "is " + std::to_string(from)
                                      : std::to_string(from) + " becomes " + std::to_string(to);
  return actions.action(*wire.counter, name, [&] {
    ModelActions::Steps steps(actions.model(*wire.counter).automaton.size());
    steps[from] = {{to, false}};
    return steps;
  });
}
ModelUse count_one_less(const Wire& wire, ModelActions& actions) {
  return actions.action(*wire.counter, "one less", [&] {
    ModelActions::Steps steps(actions.model(*wire.counter).automaton.size());
    for (StateId at = 1; at < steps.size(); ++at) steps[at] = {{at - 1, false}};
    return steps;
  });
}
// The model takes that many more, or it does not.
ModelUse has_room(const Wire& wire, ModelActions& actions, std::uint32_t needed, bool has) {
  const std::string name =
      (has ? "has room for " : "has no room for ") + std::to_string(needed) + " more";
  return actions.action(wire.to, name, [&] {
    ModelActions::Steps steps(wire.room->size());
    for (StateId at = 0; at < steps.size(); ++at) {
      if (has_room_for(wire, at, needed) == has) steps[at] = {{at, false}};
    }
    return steps;
  });
}

// What putting the input on the wire does to it and to what counts for it, and whether that pushes
// out the oldest; each way where the others are not.
struct WayToPut {
  Uses uses;
  bool pushes_out = false;
};
std::vector<WayToPut> ways_to_put(const Sending& sending, ModelActions& actions) {
  const Wire& wire = *sending.wire;
  const std::uint32_t letter = letter_of(wire, sending.input, sending.caller);
  if (!wire.counter && wire.place.order == nullptr)
    return {{{use(wire, actions, Kind::put, letter)}}};
  std::vector<WayToPut> ways;
  const auto add = [&](Uses uses, bool pushes_out) {
    if (actions.are_possible(uses)) ways.push_back({std::move(uses), pushes_out});
  };
  if (!wire.counter) {
    add({use(wire, actions, Kind::add, letter)}, false);
    add({use(wire, actions, Kind::push_out, letter)}, true);
    return ways;
  }
  for (std::uint32_t held = 0; held <= most_counted(wire, actions); ++held) {
    if (held < most_counted(wire, actions)) {
      add({use(wire, actions, Kind::add, letter), count(wire, actions, held, held + 1),
           has_room(wire, actions, held + 1, true)},
          false);
    }
    add({use(wire, actions, Kind::push_out, letter), count(wire, actions, held, held),
         has_room(wire, actions, held, true)},
        true);
  }
  return ways;
}

}  // namespace

std::vector<ConnectionInstance> add_wires(const Declarations& file, Models& models) {
  return WireMaker(file, models).make();
}

std::vector<Uses> ways_to_send(const std::vector<Sending>& all, ModelActions& actions) {
  struct Way {
    Uses uses;
    std::map<std::uint32_t, std::vector<StreamModel::Sent>> streams;  // by model
  };
  std::vector<Way> ways{{}};
  std::map<std::uint32_t, StreamModel*> orders;
  for (const Sending& sending : all) {
    const Wire* const wire = sending.wire;
    if (wire->place.order != nullptr) orders[wire->place.stream] = wire->place.order.get();
    const std::vector<WayToPut> own = ways_to_put(sending, actions);
    std::vector<Way> longer;
    for (const Way& before : ways) {
      for (const auto& [uses, pushes_out] : own) {
        Way& way = longer.emplace_back(before);
        way.uses.insert(way.uses.end(), uses.begin(), uses.end());
        if (wire->place.order != nullptr) {
          way.streams[wire->place.stream].push_back({wire->place.number, pushes_out});
        }
      }
    }
    ways = std::move(longer);
  }
  std::vector<Uses> result;
  for (Way& way : ways) {
    for (const auto& [stream, sent] : way.streams) {
      way.uses.push_back(orders.at(stream)->send(actions, stream, sent));
    }
    result.push_back(std::move(way.uses));
  }
  return result;
}

std::vector<Uses> ways_to_wait(const Wire& wire, ModelActions& actions) {
  std::vector<Uses> ways;
  const auto add = [&](Uses uses) {
    if (actions.are_possible(uses)) ways.push_back(std::move(uses));
  };
  add({use(wire, actions, Kind::is_full)});
  if (!wire.counter) return ways;
  for (std::uint32_t held = 0; held <= most_counted(wire, actions); ++held) {
    add({count(wire, actions, held, held), has_room(wire, actions, held + 1, false)});
  }
  return ways;
}

const Wire* counted_wire(const Names& names, std::uint32_t model) {
  const auto place = names.wires.find(model);
  if (place == names.wires.end() || place->second.empty()) return nullptr;
  const Wire& wire = place->second.front();
  return wire.counter ? &wire : nullptr;
}

ModelUse when_counted(const Wire& wire, ModelActions& actions, std::uint32_t held) {
  return count(wire, actions, held, held);
}

Uses when_dies(std::uint32_t program, const Names& names, ModelActions& actions) {
  std::set<std::uint32_t> own;  // models that it reads
  for (const Topic& topic : names.topics) {
    for (const Topic::Reader& reader : topic.readers) {
      if (reader.program == program && reader.gone) own.insert(reader.model);
    }
  }
  Uses uses;
  std::map<std::uint32_t, std::pair<StreamModel*, std::vector<std::uint32_t>>> forgotten;
  for (const auto& [to, wires] : names.wires) {
    for (const Wire& wire : wires) {
      if (own.contains(to)) {
        uses.push_back(use(wire, actions, Kind::clear));
        if (wire.place.order == nullptr) continue;
        auto& [order, numbers] = forgotten[wire.place.stream];
        order = wire.place.order.get();
        numbers.push_back(wire.place.number);
      } else if (wire.from.is_of("", program)) {
        uses.push_back(use(wire, actions, Kind::abandon));
      }
    }
  }
  for (const auto& [stream, gone] : forgotten) {
    uses.push_back(gone.first->forget(actions, stream, gone.second));
  }
  return uses;
}

ModelUse when_empty(const Wire& wire, ModelActions& actions) {
  return use(wire, actions, Kind::is_empty);
}

Uses when_all_arrived(const std::vector<const Wire*>& wires, ModelActions& actions) {
  Uses uses;
  for (const Wire* const wire : wires) uses.push_back(when_empty(*wire, actions));
  return uses;
}

std::vector<Uses> ways_not_all_arrived(const std::vector<const Wire*>& wires,
                                       ModelActions& actions) {
  std::vector<Uses> ways;
  Uses before;
  for (const Wire* const wire : wires) {
    ways.push_back(before);
    ways.back().push_back(use(*wire, actions, Kind::is_used));
    before.push_back(when_empty(*wire, actions));
  }
  return ways;
}

// ---- Arrivals -----------------------------------------------------------------------------------

namespace {

// What may come of the oldest message on a wire: it arrives, or is lost.
class Coming {
 public:
  // `from`: " from camera", for texts; may be empty.
  Coming(const Wire& wire, ModelActions& actions, std::string from)
      : wire_(wire), actions_(actions), from_(std::move(from)) {}

  // `connection`: what leads to that model: "map", "image[logger]".
  CombinedStep arrival(Kind kind, std::uint32_t letter, const std::string& connection) {
    const Symbol input = wire_.letters[letter % wire_.letters.size()];
    const std::string& name = actions_.model(wire_.to).automaton.inputs().name(input);
    CombinedStep step;
    step.uses = {{ModelUse::Kind::give, wire_.to, input}};
    add_leaving(kind, letter, step);
    step.events = {{ModelUse::Kind::take, wire_.model, wire_.rules->arrives(letter)}};
    step.text = connection + "!arrives" + name.substr(base_of(name).size()) + from_;
    step.fair = wire_.group;
    return step;
  }
  CombinedStep loss(Kind kind, std::uint32_t letter, const std::string& connection) {
    CombinedStep step;
    step.uses = {takes()};
    add_leaving(kind, letter, step);
    step.events = {{ModelUse::Kind::take, wire_.model, WireModel::lost}};
    step.text = connection + "!lost" + from_;
    return step;
  }

 private:
  void add_leaving(Kind kind, std::uint32_t letter, CombinedStep& step) {
    step.uses.push_back(use(wire_, actions_, kind, letter));
    if (wire_.counter) step.uses.push_back(count_one_less(wire_, actions_));
    if (wire_.place.order) {
      step.uses.push_back(
          wire_.place.order->leave(actions_, wire_.place.stream, wire_.place.number));
    }
  }

  // A condition: something on the wire may arrive. What is lost is so in its turn.
  ModelUse takes() {
    return actions_.action(
        wire_.to, "takes what " + wire_.writer + " sends",
        ModelActions::StepsOfState([&actions = actions_, to = wire_.to,
                                    letters = wire_.letters](StateId at) {
          const bool takes = std::ranges::any_of(letters, [&](Symbol letter) {
            return !model_steps(actions.model(to), at, {ModelUse::Kind::give, 0, letter}).empty();
          });
          return takes ? std::vector<ModelStep>{{at, false}} : std::vector<ModelStep>{};
        }));
  }

  const Wire& wire_;
  ModelActions& actions_;
  std::string from_;
};

std::string from_of(const Wire& wire, const Names& names) {
  return names.wires.at(wire.to).size() > 1 ? " from " + wire.writer : "";
}

}  // namespace

namespace {

// Something of the service's arrives or is lost.
CombinedStep step_of_service(const Service& service, std::uint32_t model,
                             const ServiceModel::Operation& operation, ModelActions& actions) {
  using Operation = ServiceModel::Operation;
  const ServiceShape& shape = service.rules->shape();
  const bool is_request = operation.kind == Operation::Kind::request_arrives ||
                          operation.kind == Operation::Kind::request_lost;
  const bool is_lost = operation.kind == Operation::Kind::request_lost ||
                       operation.kind == Operation::Kind::answer_lost ||
                       operation.kind == Operation::Kind::loss_returns;
  const std::uint32_t client = operation.client;
  CombinedStep step;
  step.uses = {service.rules->use(actions, model, operation)};
  const PlaceInStream& place =
      is_request ? service.requests_in[client] : service.answers_in[client];
  if (place.order) step.uses.push_back(place.order->leave(actions, place.stream, place.number));
  step.events = {{ModelUse::Kind::take, model, service.rules->symbol_of(operation)}};
  step.text = service.name + (shape.names.size() > 1 ? "[" + shape.names[client] + "]" : "") +
              (is_request ? "!request" : "!answer") + (is_lost ? "_lost" : "_arrives");
  if (is_lost) return step;
  for (const ServiceWay& way : ways_of(service)) {
    if (way.client == client && way.is_request == is_request) break;
    ++step.fair;
  }
  step.fair += service.group;
  return step;
}

}  // namespace

bool is_on_its_way(const Service& service) { return !ways_of(service).empty(); }

std::vector<Uses> ways_to_use(const Service& service, std::uint32_t model,
                              const ServiceModel::Operation& operation, ModelActions& actions) {
  using Operation = ServiceModel::Operation;
  const bool is_request = operation.kind == Operation::Kind::send;
  std::vector<std::uint32_t> to;  // clients
  for (const ServiceWay& way : ways_of(service)) {
    if (operation.kind != Operation::Kind::answer && !is_request) continue;
    if (way.is_request != is_request || (is_request && way.client != operation.client)) continue;
    to.push_back(way.client);
  }
  const auto& places = is_request ? service.requests_in : service.answers_in;
  const bool is_in_stream = std::ranges::any_of(
      to, [&](std::uint32_t client) { return places[client].order != nullptr; });
  if (!is_in_stream) return {{service.rules->use(actions, model, operation)}};
  std::vector<Uses> ways;
  for (std::uint32_t which = 0; which < 1U << to.size(); ++which) {
    Operation one = operation;
    one.pushes_out = 0;
    std::map<std::uint32_t, std::pair<StreamModel*, std::vector<StreamModel::Sent>>> streams;
    for (std::size_t i = 0; i < to.size(); ++i) {
      const bool pushes = (which >> i & 1) != 0;
      if (pushes) *one.pushes_out |= 1U << to[i];
      const PlaceInStream& place = places[to[i]];
      if (place.order == nullptr) continue;
      auto& [order, sent] = streams[place.stream];
      order = place.order.get();
      sent.push_back({place.number, pushes});
    }
    Uses& uses = ways.emplace_back();
    uses.push_back(service.rules->use(actions, model, one));
    for (const auto& [stream, way] : streams) {
      uses.push_back(way.first->send(actions, stream, way.second));
    }
  }
  return ways;
}

std::vector<CombinedStep> ends_of_answer(const Service& service, std::uint32_t model,
                                         std::uint32_t caller, ModelActions& actions) {
  using Kind = ServiceModel::Operation::Kind;
  std::vector<CombinedStep> ends;
  for (const ServiceWay& way : ways_of(service)) {
    for (const Kind kind : {Kind::answer_returns, Kind::loss_returns}) {
      ends.push_back(step_of_service(service, model, {kind, way.client, 0, caller}, actions));
      ends.back().role =
          kind == Kind::answer_returns ? CombinedStep::Role::arrival : CombinedStep::Role::loss;
    }
  }
  return ends;
}

std::vector<CombinedStep> ends_of_call(const std::vector<const Wire*>& wires, std::uint32_t caller,
                                       const Names& names, ModelActions& actions) {
  std::vector<CombinedStep> ends;
  for (const Wire* const wire : wires) {
    const auto add = [&](CombinedStep step, CombinedStep::Role role) {
      step.role = role;
      for (const Wire* const other : wires) {
        if (other == wire) continue;
        step.uses.push_back(use(*other, actions, Kind::holds_none, caller_of(*other, caller)));
      }
      if (actions.are_possible(step.uses)) ends.push_back(std::move(step));
    };
    Coming coming(*wire, actions, from_of(*wire, names));
    const std::string& connection = actions.model(wire->to).name;
    for (const Symbol input : wire->letters) {
      const std::uint32_t letter = letter_of(*wire, input, caller);
      add(coming.arrival(Kind::arrive_of_living, letter, connection), CombinedStep::Role::arrival);
      add(coming.loss(Kind::lose_of_living, letter, connection), CombinedStep::Role::loss);
    }
  }
  return ends;
}

Uses when_returned(const std::vector<const Wire*>& wires, std::uint32_t caller,
                   ModelActions& actions) {
  Uses uses;
  for (const Wire* const wire : wires) {
    uses.push_back(use(*wire, actions, Kind::holds_none, caller_of(*wire, caller)));
  }
  return uses;
}

namespace {

class ArrivalMaker {
 public:
  ArrivalMaker(const Declarations& file, const Names& names, System& system, ModelActions& actions)
      : file_(file), names_(names), system_(system), actions_(actions) {}

  void make() {
    system_.nobodys_actions.clear();
    system_.nobodys_groups.assign(1, "");
    for (const auto& [to, wires] : names_.wires) {
      for (const Wire& wire : wires) add(wire);
    }
    for (const auto& [model, service] : names_.services) add(model, service);
  }

 private:
  // What leads to that model.
  std::string connection_of(std::uint32_t to) const {
    const auto reader = file_.topic_of.find(to);
    if (reader == file_.topic_of.end()) return system_.models[to].name;
    const Topic& topic = names_.topics[reader->second.first];
    return topic.readers.size() == 1 ? topic.name : system_.models[to].name;
  }

  void add(const Wire& wire) {
    MAIDE_CHECK(wire.group == system_.nobodys_groups.size());
    system_.nobodys_groups.push_back("what is on its way from " + wire.writer + " to " +
                                     system_.models[wire.to].name);
    const std::string connection = connection_of(wire.to);
    Coming coming(wire, actions_, from_of(wire, names_));
    const auto letters = static_cast<std::uint32_t>(wire.letters.size());
    if (wire.callers.empty()) {
      for (std::uint32_t letter = 0; letter < letters; ++letter) {
        add(wire, coming.arrival(Kind::arrive, letter, connection));
      }
      if (!actions_.are_possible({use(wire, actions_, Kind::lose)})) return;
      return add(wire, coming.loss(Kind::lose, 0, connection));
    }
    // What ends a call is a step of its program.
    for (std::uint32_t caller = 0; caller < wire.callers.size(); ++caller) {
      const std::vector<Uses> ways = ways_not_to_return(wire, wire.callers[caller]);
      for (std::uint32_t input = 0; input < letters; ++input) {
        const std::uint32_t letter = wire.rules->letter_of(input, caller);
        add(wire, coming.arrival(Kind::arrive_of_dead, letter, connection));
        add(wire, coming.loss(Kind::lose_of_dead, letter, connection));
        for (const Uses& others : ways) {
          add(wire, coming.arrival(Kind::arrive_of_living, letter, connection), others);
          add(wire, coming.loss(Kind::lose_of_living, letter, connection), others);
        }
      }
    }
  }

  // The message of that program is on its way to another reader, too: conditions.
  std::vector<Uses> ways_not_to_return(const Wire& wire, std::uint32_t program) {
    std::vector<Uses> ways;
    Uses before;
    const Topic& topic = names_.topics[file_.topic_of.at(wire.to).first];
    for (const Topic::Reader& reader : topic.readers) {
      if (reader.model == wire.to) continue;
      const Wire* const other = names_.wire_of(reader.model, wire.from.node, program);
      if (other == nullptr || other->callers.empty()) continue;
      const std::uint32_t caller = caller_of(*other, program);
      ways.push_back(before);
      ways.back().push_back(use(*other, actions_, Kind::holds, caller));
      before.push_back(use(*other, actions_, Kind::holds_none, caller));
    }
    return ways;
  }

  void add(const Wire& wire, CombinedStep step, const Uses& conditions = {}) {
    step.uses.insert(step.uses.end(), conditions.begin(), conditions.end());
    if (!wire.callers.empty() && !actions_.are_possible(step.uses)) return;
    NobodysAction action;
    action.counts_for_deadlock = step.fair != 0;
    if (step.fair == 0) action.lost = "a message of " + connection_of(wire.to);
    action.what = std::move(step);
    add(std::move(action), wire.to);
  }

  void add(std::uint32_t model, const Service& service) {
    using enum ServiceModel::Operation::Kind;
    const ServiceShape& shape = service.rules->shape();
    for (const auto& [client, is_request] : ways_of(service)) {
      const std::string& name = shape.names[client];
      system_.nobodys_groups.push_back(
          (is_request ? "requests on their way from " : "answers on their way to ") + name);
      const auto step = [&, client = client](ServiceModel::Operation::Kind kind) {
        return step_of_service(service, model, {kind, client, 0}, actions_);
      };
      NobodysAction arrival;
      arrival.what = step(is_request ? request_arrives : answer_arrives);
      MAIDE_CHECK(arrival.what.fair + 1 == system_.nobodys_groups.size());
      add(std::move(arrival), model);
      NobodysAction loss;
      loss.what = step(is_request ? request_lost : answer_lost);
      loss.counts_for_deadlock = false;
      loss.lost = "a" + std::string(is_request ? " request of " : "n answer to ") + name;
      add(std::move(loss), model);
    }
  }

  void add(NobodysAction action, std::uint32_t to) {
    std::ranges::sort(action.what.uses, {}, &ModelUse::model);
    action.position = system_.models[to].position;
    system_.nobodys_actions.push_back(std::move(action));
  }

  const Declarations& file_;
  const Names& names_;
  System& system_;
  ModelActions& actions_;
};

}  // namespace

void add_arrivals(const Declarations& file, const Names& names, System& system,
                  ModelActions& actions) {
  ArrivalMaker(file, names, system, actions).make();
}

}  // namespace maide
