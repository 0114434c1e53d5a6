#include "maide/check/unroll/wire_uses.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/check/rules/stream.hpp"

namespace maide {
namespace {

using WireUse = WireModel::Operation::Kind;

}  // namespace

std::uint32_t most_counted(const Wire& wire, const ModelActions& actions) {
  return static_cast<std::uint32_t>(actions.model(*wire.counter).automaton.size() - 1);
}

bool has_room_for(const Wire& wire, StateId state, std::uint32_t needed) {
  const auto& room = (*wire.room)[state];
  return !room || *room >= needed;
}

std::uint32_t caller_of(const Wire& wire, std::uint32_t program) {
  if (wire.callers.empty()) return 0;
  const auto place = std::ranges::find(wire.callers, program);
  MAIDE_CHECK(place != wire.callers.end());
  return static_cast<std::uint32_t>(place - wire.callers.begin());
}

ModelUse use(const Wire& wire, ModelActions& actions, WireUse kind, std::uint32_t letter) {
  return wire.rules->use(actions, wire.model, {kind, letter});
}

namespace {

std::uint32_t letter_of(const Wire& wire, Symbol input, std::uint32_t program) {
  const auto place = std::ranges::find(wire.letters, input) - wire.letters.begin();
  return wire.rules->letter_of(static_cast<std::uint32_t>(place), caller_of(wire, program));
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
    return {{{use(wire, actions, WireUse::put, letter)}}};
  std::vector<WayToPut> ways;
  const auto add = [&](Uses uses, bool pushes_out) {
    if (actions.are_possible(uses)) ways.push_back({std::move(uses), pushes_out});
  };
  if (!wire.counter) {
    add({use(wire, actions, WireUse::add, letter)}, false);
    add({use(wire, actions, WireUse::push_out, letter)}, true);
    return ways;
  }
  for (std::uint32_t held = 0; held <= most_counted(wire, actions); ++held) {
    if (held < most_counted(wire, actions)) {
      add({use(wire, actions, WireUse::add, letter), count(wire, actions, held, held + 1),
           has_room(wire, actions, held + 1, true)},
          false);
    }
    add({use(wire, actions, WireUse::push_out, letter), count(wire, actions, held, held),
         has_room(wire, actions, held, true)},
        true);
  }
  return ways;
}

}  // namespace

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
  add({use(wire, actions, WireUse::is_full)});
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

ModelUse when_empty(const Wire& wire, ModelActions& actions) {
  return use(wire, actions, WireUse::is_empty);
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
    ways.back().push_back(use(*wire, actions, WireUse::is_used));
    before.push_back(when_empty(*wire, actions));
  }
  return ways;
}

// ---- Arrivals -----------------------------------------------------------------------------------

CombinedStep Coming::arrival(Kind kind, std::uint32_t letter, const std::string& connection) {
  const Symbol input = wire_.letters[letter % wire_.letters.size()];
  const std::string& name = actions_.model(wire_.to).automaton.inputs().name(input);
  CombinedStep step;
  step.uses = {{ModelUse::Kind::give, wire_.to, input}};
  add_leaving(kind, letter, step);
  step.events = {{ModelUse::Kind::take, wire_.model, wire_.rules->arrives(letter)}};
  step.text = connection + "!arrives" + name.substr(std::min(name.find('('), name.size())) + from_;
  step.fair = wire_.group;
  return step;
}

CombinedStep Coming::loss(Kind kind, std::uint32_t letter, const std::string& connection) {
  CombinedStep step;
  step.uses = {takes()};
  add_leaving(kind, letter, step);
  step.events = {{ModelUse::Kind::take, wire_.model, WireModel::lost}};
  step.text = connection + "!lost" + from_;
  return step;
}

void Coming::add_leaving(Kind kind, std::uint32_t letter, CombinedStep& step) {
  step.uses.push_back(use(wire_, actions_, kind, letter));
  if (wire_.counter) step.uses.push_back(count_one_less(wire_, actions_));
  if (wire_.place.order) {
    step.uses.push_back(wire_.place.order->leave(actions_, wire_.place.stream, wire_.place.number));
  }
}

ModelUse Coming::takes() {
  return actions_.action(
      wire_.to, "takes what " + wire_.writer + " sends",
      ModelActions::StepsOfState(
          [&actions = actions_, to = wire_.to, letters = wire_.letters](StateId at) {
            const bool takes = std::ranges::any_of(letters, [&](Symbol letter) {
              return !model_steps(actions.model(to), at, {ModelUse::Kind::give, 0, letter}).empty();
            });
            return takes ? std::vector<ModelStep>{{at, false}} : std::vector<ModelStep>{};
          }));
}

std::string from_of(const Wire& wire, const Names& names) {
  return names.wires.at(wire.to).size() > 1 ? " from " + wire.writer : "";
}

std::vector<ServiceWay> ways_of(const Service& service) {
  const ServiceShape& shape = service.rules->shape();
  std::vector<ServiceWay> ways;
  for (std::uint32_t client = 0; client < shape.is_late.size(); ++client) {
    if (shape.is_late[client]) ways.push_back({client, true});
    if (shape.is_late[client] || shape.callers > 0) ways.push_back({client, false});
  }
  return ways;
}

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

bool is_on_its_way(const Service& service) { return !ways_of(service).empty(); }

namespace {

// Where the server is there.
std::vector<Uses> ways_when_there(const Service& service, std::uint32_t model,
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

}  // namespace

std::vector<Uses> ways_to_use(const Service& service, std::uint32_t model,
                              const ServiceModel::Operation& operation, ModelActions& actions) {
  using Kind = ServiceModel::Operation::Kind;
  std::vector<Uses> ways = ways_when_there(service, model, operation, actions);
  if (operation.kind != Kind::send || !service.presence) return ways;
  const std::vector<bool> is_there{false, true}, is_not{true, false};
  for (Uses& way : ways) {
    way.push_back(actions.variable(*service.presence, &is_there, std::nullopt));
  }
  ServiceModel::Operation in_vain = operation;
  in_vain.kind = Kind::send_in_vain;
  ways.push_back({service.rules->use(actions, model, in_vain),
                  actions.variable(*service.presence, &is_not, std::nullopt)});
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
        step.uses.push_back(use(*other, actions, WireUse::holds_none, caller_of(*other, caller)));
      }
      if (actions.are_possible(step.uses)) ends.push_back(std::move(step));
    };
    Coming coming(*wire, actions, from_of(*wire, names));
    const std::string& connection = actions.model(wire->to).name;
    for (const Symbol input : wire->letters) {
      const std::uint32_t letter = letter_of(*wire, input, caller);
      add(coming.arrival(WireUse::arrive_of_living, letter, connection),
          CombinedStep::Role::arrival);
      add(coming.loss(WireUse::lose_of_living, letter, connection), CombinedStep::Role::loss);
    }
  }
  return ends;
}

Uses when_returned(const std::vector<const Wire*>& wires, std::uint32_t caller,
                   ModelActions& actions) {
  Uses uses;
  for (const Wire* const wire : wires) {
    uses.push_back(use(*wire, actions, WireUse::holds_none, caller_of(*wire, caller)));
  }
  return uses;
}

}  // namespace maide
