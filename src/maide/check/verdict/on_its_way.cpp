#include "maide/check/verdict/on_its_way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "maide/check/rules/wire.hpp"
#include "maide/check/verdict/service_account.hpp"

namespace maide {
namespace {

// Tells what is on its way in one state of a run, connection by connection.
class OnItsWay {
 public:
  OnItsWay(const System& system, const Trace& trace, const std::vector<GlobalState>& states)
      : system_(system), trace_(trace), states_(states) {}

  std::vector<std::string> find() {
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
      const ServiceInstance* const service = find_service(system_, index);
      if (service != nullptr && !system_.models[index].service_contents.empty()) {
        add_service(*service);
      } else if (system_.models[index].source == ModelInstance::Source::wire) {
        add_wire(index);
      }
    }
    return std::move(found_);
  }

 private:
  // `is_sending`: whether the step at that place sends one of them. Messages keep their order.
  template <typename IsSending>
  void add(const std::string& what, std::size_t held, const IsSending& is_sending) {
    found_.push_back(what);
    std::size_t newer = held - 1;
    for (std::size_t at = trace_.steps.size(); at-- > 0;) {
      if (!is_sending(at) || newer-- != 0) continue;
      found_.back() += fmt::format(", {}sent at step {}", held > 1 ? "the first " : "", at + 1);
      return;
    }
  }

  void add_wire(std::uint32_t index) {
    const ModelInstance& wire = system_.models[index];
    const StateId state = states_.back().models[index];
    if (state >= wire.state_texts.size()) return;
    const std::size_t held = WireModel::count_in(wire.state_texts[state]);
    if (held == 0) return;
    const WireEnds ends = ends_of_wire(wire.name);
    add(fmt::format("{} from {} to {}", wire.state_texts[state], ends.writer,
                    target_of(ends.model)),
        held, [&](std::size_t at) {
          const Step& step = trace_.steps[at];
          const CombinedStep* const combined = combined_step_of(system_, step);
          const bool dies = combined != nullptr && combined->role == CombinedStep::Role::death;
          return step.actor != nobody && !dies &&
                 std::ranges::any_of(uses_of(system_, step),
                                     [&](const ModelUse& use) { return use.model == index; });
        });
  }

  void add_service(const ServiceInstance& service) {
    for (std::uint32_t client = 0; client < service.clients.size(); ++client) {
      const std::string& name = service.clients[client];
      add_of_client(service, client, &ServiceContents::sent, "a request", "requests",
                    " of " + name + " to " + service.name);
      add_of_client(service, client, &ServiceContents::coming, "an answer", "answers",
                    " of " + service.name + " to " + name);
    }
  }

  void add_of_client(const ServiceInstance& service, std::uint32_t client,
                     std::vector<std::uint32_t> ServiceContents::*wires, const std::string& one,
                     const std::string& several, const std::string& ends) {
    const auto held_at = [&](std::size_t at) {
      const auto& contents = system_.models[service.model].service_contents;
      return (contents[states_[at].models[service.model]].*wires)[client];
    };
    const std::size_t held = held_at(trace_.steps.size());
    if (held == 0) return;
    add((held == 1 ? one : fmt::format("{} {}", held, several)) + ends, held,
        [&](std::size_t at) { return held_at(at) < held_at(at + 1); });
  }

  // "map" of a topic with one reader, "map[robot]" of one of several.
  std::string target_of(const std::string& model) const {
    for (const TopicInstance& topic : system_.topics) {
      if (topic.readers.size() == 1 && system_.models[topic.readers.front().model].name == model) {
        return topic.name;
      }
    }
    return model;
  }

  const System& system_;
  const Trace& trace_;
  const std::vector<GlobalState>& states_;
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> find_on_its_way(const System& system, const Trace& trace,
                                         const std::vector<GlobalState>& states) {
  return OnItsWay(system, trace, states).find();
}

}  // namespace maide
