#include "maide/check/unroll/death_steps.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "maide/check/rules/stream.hpp"
#include "maide/check/unroll/wire_uses.hpp"

namespace maide {
namespace {

using WireUse = WireModel::Operation::Kind;
using ServiceUse = ServiceModel::Operation::Kind;

class DeathMaker {
 public:
  DeathMaker(const Dying& who, const Names& names, ModelActions& actions)
      : who_(who), names_(names), actions_(actions) {}

  std::vector<Uses> ways_to_die() {
    std::vector<Uses> ways{of_models()};
    for (const Topic& topic : names_.topics) {
      ways = combine_all(ways, ways_at(topic));
    }
    Uses others = of_wires();
    add_services(ServiceUse::die, others);
    for (Uses& way : ways) way.insert(way.end(), others.begin(), others.end());
    return ways;
  }

  // Its services are there no more.
  Uses when_all_know() {
    Uses uses;
    for (const auto& [model, service] : names_.services) {
      if (!service.presence || !is_own(service.server)) continue;
      uses.push_back(actions_.variable(*service.presence, nullptr, 0));
    }
    return uses;
  }

  Uses when_begins_anew() {
    Uses uses;
    std::map<std::uint32_t, std::uint32_t> counters;  // and one model that each counts for
    for (const Topic& topic : names_.topics) {
      for (const Topic::Reader& reader : topic.readers) {
        if (!is_own(reader.program) || !reader.gone) continue;
        uses.push_back(to_initial(reader.model, "comes again"));
        const auto wires = names_.wires.find(reader.model);
        if (wires == names_.wires.end()) continue;
        for (const Wire& wire : wires->second) {
          if (wire.counter) counters.emplace(*wire.counter, reader.model);
        }
      }
    }
    for (const auto& [counter, counted] : counters) {
      uses.push_back(to_initial(counter, "begins anew"));
    }
    add_cleared(uses);
    add_services(ServiceUse::begin_anew, uses);
    return uses;
  }

 private:
  bool is_own(std::uint32_t program) const {
    return std::ranges::find(who_.programs, program) != who_.programs.end();
  }
  bool is_own(const End& end) const {
    return end.node.empty() ? is_own(end.program)
                            : std::ranges::find(who_.nodes, end.node) != who_.nodes.end();
  }
  ModelUse to_initial(std::uint32_t model, const std::string& name) {
    return actions_.action(
        model, name, ModelActions::StepsOfState([this, model](StateId) {
          return std::vector<ModelStep>{{actions_.model(model).automaton.initial(), false}};
        }));
  }

  static std::vector<Uses> combine_all(const std::vector<Uses>& before,
                                       const std::vector<Uses>& ways) {
    std::vector<Uses> all;
    for (const Uses& one : before) {
      for (const Uses& way : ways) {
        all.push_back(one);
        all.back().insert(all.back().end(), way.begin(), way.end());
      }
    }
    return all;
  }

  // Those that say under `ends:` who stands where.
  Uses of_models() {
    Uses uses;
    std::set<std::uint32_t> used{who_.own_models.begin(), who_.own_models.end()};
    for (const std::uint32_t own : who_.own_models) {
      uses.push_back(to_initial(own, "begins anew"));
    }
    for (const std::uint32_t program : who_.programs) {
      const auto own = names_.deaths.find(program);
      if (own == names_.deaths.end()) continue;
      for (const auto& [model, steps] : own->second) {
        if (std::ranges::find(who_.own_models, model) != who_.own_models.end()) continue;
        if (!used.insert(model).second) {
          throw ParseError("two programs of one process that may die are at ends of " +
                               actions_.model(model).name + ": that is not built",
                           actions_.model(model).position);
        }
        uses.push_back(actions_.action(model, "program " + std::to_string(program) + " dies",
                                       [&own_steps = steps] { return own_steps; }));
      }
    }
    return uses;
  }

  std::vector<Uses> ways_at(const Topic& topic) {
    const bool writes = std::ranges::any_of(
        topic.writers, [this](std::uint32_t program) { return is_own(program); });
    Uses own, calls;
    for (const Topic::Reader& reader : topic.readers) {
      if (is_own(reader.program) && reader.gone) {
        own.push_back(actions_.action(reader.model, "leaves", [&] {
          const std::size_t states = actions_.model(reader.model).automaton.size();
          return std::vector<std::vector<ModelStep>>(states, {{*reader.gone, false}});
        }));
      } else if (writes && !reader.writer_death.empty()) {
        calls.push_back(
            actions_.action(reader.model, "its writer dies", [&] { return reader.writer_death; }));
      }
    }
    const auto with = [&own](Uses uses) {
      uses.insert(uses.end(), own.begin(), own.end());
      return uses;
    };
    if (!topic.caller || !writes) return {with(calls)};
    const ValueType& type = actions_.model(*topic.caller).type;
    std::vector<bool> is_own_call(type.count());
    for (const auto& [writer, word] : topic.mortal) {
      if (is_own(writer)) is_own_call[type.place_of(word)] = true;
    }
    std::vector<bool> is_other = is_own_call;
    is_other.flip();
    calls.push_back(actions_.variable(*topic.caller, &is_own_call, topic.nobody));
    return {with(calls), with({actions_.variable(*topic.caller, &is_other, std::nullopt)})};
  }

  std::set<std::uint32_t> models_read() const {
    std::set<std::uint32_t> models;
    for (const Topic& topic : names_.topics) {
      for (const Topic::Reader& reader : topic.readers) {
        if (is_own(reader.program) && reader.gone) models.insert(reader.model);
      }
    }
    return models;
  }

  // What is on its way to them is gone.
  void add_cleared(Uses& uses) {
    std::map<std::uint32_t, std::pair<StreamModel*, std::vector<std::uint32_t>>> forgotten;
    for (const std::uint32_t to : models_read()) {
      const auto wires = names_.wires.find(to);
      if (wires == names_.wires.end()) continue;
      for (const Wire& wire : wires->second) {
        uses.push_back(use(wire, actions_, WireUse::clear));
        if (wire.place.order == nullptr) continue;
        auto& [order, numbers] = forgotten[wire.place.stream];
        order = wire.place.order.get();
        numbers.push_back(wire.place.number);
      }
    }
    for (const auto& [stream, gone] : forgotten) {
      uses.push_back(gone.first->forget(actions_, stream, gone.second));
    }
  }

  Uses of_wires() {
    Uses uses;
    add_cleared(uses);
    const std::set<std::uint32_t> read = models_read();
    for (const auto& [to, wires] : names_.wires) {
      for (const Wire& wire : wires) {
        if (read.contains(to) || !is_own(wire.from)) continue;
        uses.push_back(use(wire, actions_, WireUse::abandon));
      }
    }
    return uses;
  }

  void add_services(ServiceUse what, Uses& uses) {
    for (const auto& [model, service] : names_.services) {
      ServiceModel::Operation operation{what};
      operation.caller = is_own(service.server) ? 1 : 0;
      for (std::size_t client = 0; client < service.clients.size(); ++client) {
        if (is_own(service.clients[client])) operation.run |= 1U << client;
      }
      if (operation.caller == 0 && operation.run == 0) continue;
      uses.push_back(service.rules->use(actions_, model, operation));
      if (what != ServiceUse::begin_anew || !service.presence || operation.caller == 0) continue;
      uses.push_back(to_initial(*service.presence, "is as in the beginning"));
    }
  }

  const Dying& who_;
  const Names& names_;
  ModelActions& actions_;
};

}  // namespace

std::vector<Uses> ways_to_die(const Dying& who, const Names& names, ModelActions& actions) {
  return DeathMaker(who, names, actions).ways_to_die();
}

std::vector<Uses> ways_to_die(const Life& life, LifeRules::Operation::Kind how, bool at_once,
                              const Names& names, ModelActions& actions) {
  const Dying who{life.programs, life.nodes, life.own_models};
  DeathMaker maker(who, names, actions);
  std::vector<Uses> ways = maker.ways_to_die();
  Uses others = at_once ? maker.when_all_know() : Uses{};
  others.push_back(life.rules->use(actions, life.model, {how, 0}));
  for (Uses& way : ways) way.insert(way.end(), others.begin(), others.end());
  return ways;
}

Uses when_begins_anew(const Life& life, const Names& names, ModelActions& actions) {
  const Dying who{life.programs, life.nodes};
  Uses uses = DeathMaker(who, names, actions).when_begins_anew();
  uses.push_back(life.rules->use(actions, life.model, {LifeRules::Operation::Kind::begin_anew, 0}));
  return uses;
}

}  // namespace maide
