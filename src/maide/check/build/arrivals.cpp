#include "maide/check/build/arrivals.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/unroll/death_steps.hpp"
#include "maide/check/unroll/wire_uses.hpp"

namespace maide {
namespace {

class ArrivalMaker {
 public:
  ArrivalMaker(const Declarations& file, const Names& names, System& system, ModelActions& actions)
      : file_(file), names_(names), system_(system), actions_(actions) {}

  void make() {
    system_.nobodys_actions.clear();
    system_.nobodys_groups.assign(1, "");
    for (const Life& life : names_.lives) {
      MAIDE_CHECK(life.group == system_.nobodys_groups.size());
      system_.nobodys_groups.push_back("the life of " + life.process);
    }
    for (const auto& [to, wires] : names_.wires) {
      for (const Wire& wire : wires) add(wire);
    }
    for (const auto& [model, service] : names_.services) add(model, service);
    for (const auto& [model, service] : names_.services) add_gone(model, service);
    for (const auto& [model, service] : names_.services) add_coming(model, service);
    for (const auto& [to, wires] : names_.wires) {
      for (const Wire& wire : wires) add_meeting(wire);
    }
    for (const Life& life : names_.lives) add_life(life);
  }

 private:
  using Kind = WireModel::Operation::Kind;

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

  // The server has died, and that gets about.
  void add_gone(std::uint32_t model, const Service& service) {
    if (!service.presence || !may_die(file_, service.server)) return;
    const std::vector<bool> is_there{false, true};
    NobodysAction gone;
    gone.what.text = service.name + " is gone";
    gone.what.fair = static_cast<std::uint32_t>(system_.nobodys_groups.size());
    gone.what.uses = {
        service.rules->use(actions_, model, {ServiceModel::Operation::Kind::server_is_dead}),
        actions_.variable(*service.presence, &is_there, 0)};
    system_.nobodys_groups.push_back("the news that the server of " + service.name + " is dead");
    add(std::move(gone), model);
  }

  // Anybody, the server, is there from some time on.
  void add_coming(std::uint32_t model, const Service& service) {
    if (!service.is_server_anybody || !service.presence) return;
    const std::vector<bool> is_away{true, false};
    NobodysAction comes;
    comes.what.text = service.name + " is there";
    comes.what.fair = static_cast<std::uint32_t>(system_.nobodys_groups.size());
    comes.what.uses = {actions_.variable(*service.presence, &is_away, 1)};
    system_.nobodys_groups.push_back("the server of " + service.name + ", whoever it is");
    add(std::move(comes), model);
  }

  void add_meeting(const Wire& wire) {
    if (!wire.rules->meets()) return;
    NobodysAction meeting;
    meeting.what.text = wire.writer + " meets " + system_.models[wire.to].name;
    meeting.what.fair = static_cast<std::uint32_t>(system_.nobodys_groups.size());
    meeting.what.uses = {use(wire, actions_, Kind::meet)};
    system_.nobodys_groups.push_back("that " + meeting.what.text);
    add(std::move(meeting), wire.to);
  }

  // Its death, if it may die by itself, and that it begins anew.
  void add_life(const Life& life) {
    using LifeUse = LifeRules::Operation::Kind;
    if (life.may_die) {
      for (Uses& way : ways_to_die(life, LifeUse::die, false, names_, actions_)) {
        NobodysAction death;
        death.what.text = life.process + " dies";
        death.what.uses = std::move(way);
        death.counts_for_deadlock = false;
        add(std::move(death), life.model);
      }
    }
    if (!life.may_begin_anew) return;
    NobodysAction begin;
    begin.what.text = life.process + " begins anew";
    begin.what.uses = when_begins_anew(life, names_, actions_);
    begin.what.fair = life.group;
    add(std::move(begin), life.model);
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
