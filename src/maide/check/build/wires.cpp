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
#include "maide/check/unroll/wire_uses.hpp"

namespace maide {
namespace {

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

class WireMaker {
 public:
  WireMaker(const Declarations& file, Models& models) : file_(file), models_(models) {}

  std::vector<ConnectionInstance> make() {
    if (file_.is_at_rest) return {};
    for (const Topic& topic : models_.names.topics) add_topic(topic);
    const auto writers = writers_of_models();
    for (const auto& [model, ends] : writers) add_model(model, ends);
    auto group = static_cast<std::uint32_t>(models_.names.lives.size());  // those come first
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
      if (service.is_open || service.is_server_anybody) continue;
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
      // When what anybody writes arrives, and what is written to him, makes no difference.
      if (models_.instances[reader.model].source == ModelInstance::Source::anybody) continue;
      for (const End& end : ends) {
        if (end.node.empty() && file_.programs[end.program].is_anybody) continue;
        DeliveryPlace place;
        place.is_topic = true;
        place.is_in_one_process = process_of_end(file_, end) == process_of_program(reader.program);
        DeliveryRule rule =
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
        if (topic.meets) let_meet(topic, reader, end, rule);
        add_wire(reader.model, {end, {}}, rule, callers);
        note_stream(reader.model, rule, end, process_of_program(reader.program));
      }
    }
    if (topic.meets && !connection.is_late) {
      fail(topic, "`discovery: any` goes with messages that arrive some time later" +
                      (connection.why.empty() ? "" : ", and here " + connection.why));
    }
    connections_.push_back(std::move(connection));
  }

  [[noreturn]] static void fail(const Topic& topic, const std::string& what) {
    throw ParseError("topic '" + topic.name + "': " + what, topic.position);
  }

  // The wire is to that reader; its ends meet some time after the start.
  void let_meet(const Topic& topic, const Topic::Reader& reader, const End& from,
                DeliveryRule& rule) const {
    if (rule.delivery == Delivery::acknowledged || !rule.stream.empty()) {
      fail(topic, "`discovery: any` goes with neither `delivery: acknowledged` nor `stream`");
    }
    if (file_.programs[reader.program].may_die || may_die(file_, from)) {
      fail(topic, "`discovery: any` where a writer or reader may die is not built");
    }
    const ModelInstance& model = models_.instances[reader.model];
    const Room room = room_of(model, letters_of(model.automaton));
    if (std::ranges::any_of(room, [](const auto& at) { return at.has_value(); })) {
      fail(topic, "`discovery: any` where a reader may refuse what is written is not built");
    }
    rule.wire.meets = true;
    if (!topic.keeps_for_late) return;
    if (rule.wire.keep_last == 0) {
      fail(topic, "`durability: transient_local` needs the depth of the writer");
    }
    rule.wire.kept = rule.wire.loses ? 0 : rule.wire.keep_last;  // none of best effort
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
    wire.callers = callers;
    const auto caller_count = static_cast<std::uint32_t>(callers.size());
    wire.rules = std::make_shared<WireModel>(rules, names, caller_count);
    ModelInstance instance = make_instance(wire_name(models_.instances[to].name, wire.writer), to);
    instance.automaton = wire.rules->start();
    if (wire.rules->make_all(instance.automaton, may_die(file_, writer.end), most_states)) {
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

std::vector<ConnectionInstance> add_wires(const Declarations& file, Models& models) {
  return WireMaker(file, models).make();
}

}  // namespace maide
