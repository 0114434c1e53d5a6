#include "maide/check/verdict/on_its_way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <utility>

#include "maide/check/language/system_names.hpp"
#include "maide/check/verdict/service_account.hpp"

namespace maide {
namespace {

// Follows what is sent along one run.
class SentMessages {
 public:
  SentMessages(const System& system, const Trace& trace, const std::vector<GlobalState>& states)
      : system_(system), trace_(trace), states_(states) {}

  std::vector<SentMessage> find() {
    using Kind = SentMessage::Kind;
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
      const ModelInstance& model = system_.models[index];
      const ServiceInstance* const service = find_service(system_, index);
      if (service != nullptr && !model.service_contents.empty()) {
        for (std::uint32_t client = 0; client < service->clients.size(); ++client) {
          follow_client({Kind::request, index, client, index}, &ServiceContents::sent);
          follow_client({Kind::answer, index, client, index}, &ServiceContents::coming);
        }
      } else if (!model.held.empty()) {
        follow_wire(index);
      }
    }
    return std::move(found_);
  }

 private:
  void follow_wire(std::uint32_t index) {
    const ModelInstance& wire = system_.models[index];
    const std::string target = ends_of_wire(wire.name).model;
    const auto to = std::ranges::find(system_.models, target, &ModelInstance::name);
    if (to == system_.models.end()) return;
    const auto number = static_cast<std::uint32_t>(to - system_.models.begin());
    follow(
        {SentMessage::Kind::message, index, 0, number},
        [&](std::size_t at) { return wire.held_in(states_[at].models[index]); },
        [&](std::size_t at) { return sends(trace_.steps[at], index, number); });
  }

  // The step puts a message on the wire to that model.
  bool sends(const Step& step, std::uint32_t wire, std::uint32_t to) const {
    const auto is_of = [](std::uint32_t model) {
      return [model](const ModelUse& use) { return use.model == model; };
    };
    const Alphabet& letters = system_.models[wire].automaton.inputs();
    const Alphabet& inputs = system_.models[to].automaton.inputs();
    return doer_of(system_, step) != nobody &&
           std::ranges::any_of(uses_of(system_, step), is_of(wire)) &&
           std::ranges::any_of(events_of(system_, step), [&](const ModelUse& event) {
             return event.model == to && event.kind == ModelUse::Kind::give &&
                    letters.find(inputs.name(event.index)).has_value();
           });
  }

  void follow_client(const SentMessage& sent, std::vector<std::uint32_t> ServiceContents::*on_way) {
    const auto& contents = system_.models[sent.model].service_contents;
    const auto held = [&](std::size_t at) {
      return (contents[states_[at].models[sent.model]].*on_way)[sent.client];
    };
    follow(sent, held, [&](std::size_t at) { return held(at) < held(at + 1); });
  }

  // `held`: how many are on their way before a step; `sends`: whether that step sends one.
  template <typename Held, typename Sends>
  void follow(SentMessage message, const Held& held, const Sends& sends) {
    std::deque<std::size_t> on_way;  // places in found_, oldest first
    for (std::size_t at = 0; at < trace_.steps.size(); ++at) {
      if (sends(at)) {
        message.sent = at;
        on_way.push_back(found_.size());
        found_.push_back(message);
      }
      const Step& step = trace_.steps[at];
      // What is sent may push out the oldest, and whoever dies takes all with it.
      const bool arrives = doer_of(system_, step) == nobody && lost_by(system_, step).empty();
      for (const std::size_t left = held(at + 1); on_way.size() > left; on_way.pop_front()) {
        found_[on_way.front()].ended = at;
        found_[on_way.front()].is_lost = !arrives;
      }
    }
  }

  const System& system_;
  const Trace& trace_;
  const std::vector<GlobalState>& states_;
  std::vector<SentMessage> found_;
};

// "map" of a topic with one reader, "map[robot]" of one of several.
std::string target_of(const System& system, const std::string& model) {
  for (const TopicInstance& topic : system.topics) {
    if (topic.readers.size() == 1 && system.models[topic.readers.front().model].name == model) {
      return topic.name;
    }
  }
  return model;
}

// "2 messages: 3, 4 from left to scan[log]", "a request of robot to lookup".
std::string describe(const System& system, const GlobalState& state, const SentMessage& message,
                     std::size_t count) {
  using Kind = SentMessage::Kind;
  if (message.kind == Kind::message) {
    const ModelInstance& wire = system.models[message.model];
    const WireEnds ends = ends_of_wire(wire.name);
    return fmt::format("{} from {} to {}", wire.state_texts[state.models[message.model]],
                       ends.writer, target_of(system, ends.model));
  }
  const ServiceInstance& service = *find_service(system, message.model);
  const std::string& client = service.clients[message.client];
  if (message.kind == Kind::request) {
    const std::string what = count == 1 ? "a request" : fmt::format("{} requests", count);
    return fmt::format("{} of {} to {}", what, client, service.name);
  }
  const std::string what = count == 1 ? "an answer" : fmt::format("{} answers", count);
  return fmt::format("{} of {} to {}", what, service.name, client);
}

}  // namespace

std::vector<SentMessage> find_sent(const System& system, const Trace& trace,
                                   const std::vector<GlobalState>& states) {
  return SentMessages(system, trace, states).find();
}

std::vector<std::string> find_on_its_way(const System& system, const Trace& trace,
                                         const std::vector<GlobalState>& states) {
  std::vector<SentMessage> open = find_sent(system, trace, states);
  std::erase_if(open, [](const SentMessage& message) { return message.ended.has_value(); });
  std::vector<std::string> found;
  for (auto first = open.begin(); first != open.end();) {
    const auto last = std::find_if(first, open.end(), [&](const SentMessage& message) {
      return message.model != first->model || message.client != first->client ||
             message.kind != first->kind;
    });
    const auto count = static_cast<std::size_t>(last - first);
    found.push_back(
        describe(system, states.back(), *first, count) +
        fmt::format(", {}sent at step {}", count > 1 ? "the first " : "", first->sent + 1));
    first = last;
  }
  return found;
}

}  // namespace maide
