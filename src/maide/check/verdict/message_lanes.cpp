#include "maide/check/verdict/message_lanes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "maide/check/system/components.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/check/verdict/service_account.hpp"

namespace maide {
namespace {

using UseKind = ModelUse::Kind;
using Source = ModelInstance::Source;

// Programs that are the program or run the node.
std::set<std::uint32_t> programs_named(const System& system, const std::string& name) {
  std::set<std::uint32_t> programs;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const bool runs = std::ranges::find(program.nodes, name) != program.nodes.end();
    if (runs || program.name == name) programs.insert(index);
  }
  return programs;
}

// Programs that take messages of the model.
std::set<std::uint32_t> find_takers(const System& system, std::uint32_t model) {
  const Alphabet& outputs = system.models[model].automaton.outputs();
  std::set<std::uint32_t> takers;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const bool takes = std::ranges::any_of(program.edges, [&](const ProgramEdge& edge) {
      return std::ranges::any_of(program.events_of(edge), [&](const ModelUse& event) {
        return event.model == model && event.kind == UseKind::take &&
               is_message_name(outputs.name(event.index));
      });
    });
    if (takes) takers.insert(index);
  }
  return takers;
}

}  // namespace

MessageLanes::MessageLanes(const System& system)
    : of_model_(system.models.size()),
      is_message_(system.models.size()),
      is_shared_(system.models.size(), false) {
  for (std::uint32_t model = 0; model < system.models.size(); ++model) {
    const Source source = system.models[model].source;
    if (const ServiceInstance* const service = find_service(system, model)) {
      add_service(system, *service);
    } else if (source == Source::file || source == Source::built_in) {
      add_queue(system, model);
    } else if (source != Source::wire && source != Source::anybody) {
      is_shared_[model] = true;
    }
  }
  add_wires(system);
  join_wires(system);
  for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
    ways_.push_back(find_ways(system, program));
  }
  std::vector<std::uint32_t> users(system.models.size(), 0);
  for (const Program& program : system.programs) {
    for (const std::uint32_t model : models_of(program)) ++users[model];
  }
  for (std::uint32_t model = 0; model < users.size(); ++model) {
    if (users[model] < 2) is_shared_[model] = false;
  }
  for (MessageLane& lane : lanes_) {
    for (const std::uint32_t taker : lane.takers) {
      lane.processes.insert(system.programs[taker].process);
    }
  }
}

std::optional<std::uint32_t> MessageLanes::queue_of(std::uint32_t model) const {
  for (const std::uint32_t lane : of_model_[model]) {
    if (lanes_[lane].kind == MessageLane::Kind::queue) return lane;
  }
  return std::nullopt;
}

bool MessageLanes::is_message(std::uint32_t model, Symbol input) const {
  return input < is_message_[model].size() && is_message_[model][input];
}

bool MessageLanes::add(MessageLane lane) {
  for (const std::uint32_t held : lane.held) lane.most = std::max(lane.most, held);
  if (lane.most > most_held) {
    has_unknown_ = true;
    return false;
  }
  of_model_[lane.model].push_back(static_cast<std::uint32_t>(lanes_.size()));
  lanes_.push_back(std::move(lane));
  return true;
}

void MessageLanes::add_queue(const System& system, std::uint32_t model) {
  const InterfaceAutomaton& automaton = system.models[model].automaton;
  MessageLane lane{MessageLane::Kind::queue, model, 0, count_held(system, model)};
  const bool holds = std::ranges::any_of(lane.held, [](std::uint32_t held) { return held > 0; });
  if (!holds) {
    is_shared_[model] = true;
    return;
  }
  lane.on_way.resize(lane.held.size());
  lane.takers = find_takers(system, model);
  name_queue(system, lane);
  std::vector<bool>& is_message = is_message_[model];
  is_message.resize(automaton.inputs().size());
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.action.is_input() && lane.held[transition.target] > lane.held[state]) {
        is_message[transition.action.symbol] = true;
      }
    }
  }
  add(std::move(lane));
}

void MessageLanes::name_queue(const System& system, MessageLane& lane) const {
  lane.name = system.models[lane.model].name;
  for (const TopicInstance& topic : system.topics) {
    for (const TopicInstance::Reader& reader : topic.readers) {
      if (reader.model != lane.model) continue;
      lane.topic = topic.name;
      if (topic.readers.size() == 1) lane.name = topic.name;
      if (reader.program < system.programs.size()) lane.takers.insert(reader.program);
      if (reader.callback) lane.reader = system.callbacks[*reader.callback].node;
    }
  }
  if (lane.reader.empty() && !lane.takers.empty()) {
    lane.reader = system.programs[*lane.takers.begin()].name;
  }
}

void MessageLanes::add_service(const System& system, const ServiceInstance& service) {
  const ModelInstance& model = system.models[service.model];
  if (model.service_contents.size() < model.automaton.size()) {
    has_unknown_ = true;
    return;
  }
  const bool has_several = service.clients.size() > 1;
  for (std::uint32_t client = 0; client < service.clients.size(); ++client) {
    const std::string& name = service.clients[client];
    MessageLane requests{MessageLane::Kind::requests, service.model, client};
    MessageLane answers{MessageLane::Kind::answers, service.model, client};
    for (const ServiceContents& contents : model.service_contents) {
      const auto count = [client](const std::vector<std::uint32_t>& clients) {
        return static_cast<std::uint32_t>(std::ranges::count(clients, client));
      };
      requests.on_way.push_back(contents.sent[client]);
      requests.held.push_back(count(contents.requests) + contents.sent[client]);
      requests.served.push_back(count(contents.served));
      answers.on_way.push_back(contents.coming[client]);
      answers.held.push_back(contents.answers[client] + contents.coming[client]);
    }
    requests.name =
        fmt::format("the request{} to {}", has_several ? " of " + name : "", service.name);
    answers.name =
        fmt::format("the answer of {}{}", service.name, has_several ? " to " + name : "");
    requests.reader = service.server;
    answers.reader = name;
    requests.writers = programs_named(system, name);
    answers.writers = programs_named(system, service.server);
    requests.takers = programs_named(system, service.server);
    answers.takers = programs_named(system, name);
    add(std::move(requests));
    add(std::move(answers));
  }
}

void MessageLanes::add_wires(const System& system) {
  for (std::uint32_t model = 0; model < system.models.size(); ++model) {
    const ModelInstance& wire = system.models[model];
    const std::string writer = ends_of_wire(wire.name).writer;
    // What counts what is on all wires to a model is no wire, though it stands among them.
    if (wire.source != Source::wire || writer.empty()) continue;
    MessageLane lane{MessageLane::Kind::wire, model};
    for (StateId state = 0; state < wire.automaton.size(); ++state) {
      lane.held.push_back(wire.held_in(state));
    }
    lane.on_way = lane.held;
    lane.writers = programs_named(system, writer);
    add(std::move(lane));
  }
}

void MessageLanes::join_wires(const System& system) {
  for (const NobodysAction& action : system.nobodys_actions) {
    for (const ModelUse& given : action.what.uses) {
      if (given.kind != UseKind::give) continue;
      const auto queue = queue_of(given.model);
      if (!queue) continue;
      for (const ModelUse& use : action.what.uses) {
        for (const std::uint32_t lane : of_model_[use.model]) {
          std::vector<std::uint32_t>& wires = lanes_[*queue].wires;
          const bool is_new = std::ranges::find(wires, lane) == wires.end();
          // What waits for several readers looks at the wires to the others, too.
          const bool leads_here =
              is_wire_to(system.models[use.model].name, system.models[given.model].name);
          if (lanes_[lane].is_wire() && leads_here && is_new) wires.push_back(lane);
        }
      }
    }
  }
}

std::set<MessageLanes::Way> MessageLanes::find_ways(const System& system,
                                                    std::uint32_t number) const {
  std::set<Way> ways;
  for (std::uint32_t lane = 0; lane < lanes_.size(); ++lane) {
    const bool is_of_service = lanes_[lane].kind == MessageLane::Kind::requests ||
                               lanes_[lane].kind == MessageLane::Kind::answers;
    if (is_of_service && lanes_[lane].writers.contains(number)) ways.insert({lane, lane});
  }
  const Program& program = system.programs[number];
  for (const ProgramEdge& edge : program.edges) {
    for (const ModelUse& event : program.events_of(edge)) {
      const auto queue = queue_of(event.model);
      if (event.kind != UseKind::give || !queue || !is_message(event.model, event.index)) continue;
      const auto& wires = lanes_[*queue].wires;
      const auto own = std::ranges::find_if(
          wires, [&](std::uint32_t wire) { return lanes_[wire].writers.contains(number); });
      ways.insert({own == wires.end() ? *queue : *own, *queue});
    }
  }
  return ways;
}

}  // namespace maide
