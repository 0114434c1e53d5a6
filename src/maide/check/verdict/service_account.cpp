#include "maide/check/verdict/service_account.hpp"

#include <algorithm>
#include <iterator>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// The client whose request was answered: it is among those that were served, and is no more.
std::optional<std::uint32_t> answered_client(const ServiceContents& before,
                                             const ServiceContents& after) {
  for (const std::uint32_t client : before.served) {
    if (std::ranges::count(before.served, client) > std::ranges::count(after.served, client)) {
      return client;
    }
  }
  return std::nullopt;
}

}  // namespace

const ServiceInstance* find_service(const System& system, std::uint32_t model) {
  const auto place = std::ranges::find(system.services, model, &ServiceInstance::model);
  return place == system.services.end() ? nullptr : &*place;
}

std::optional<std::uint32_t> client_named(const ServiceInstance& service, const std::string& name) {
  const auto place = std::ranges::find(service.clients, name);
  if (place == service.clients.end()) return std::nullopt;
  return static_cast<std::uint32_t>(place - service.clients.begin());
}

bool gives_at_service(const System& system, const Step& step, std::uint32_t model,
                      const std::string& input) {
  const auto events = events_of(system, step);
  return std::ranges::any_of(events, [&](const ModelUse& event) {
    return event.kind == ModelUse::Kind::give && event.model == model &&
           is_numbered(system.models[model].automaton.inputs().name(event.index), input);
  });
}

std::vector<ServiceLoss> find_service_losses(const System& system, const Trace& trace,
                                             const std::vector<GlobalState>& states,
                                             std::uint32_t model) {
  MAIDE_CHECK(states.size() == trace.steps.size() + 1);
  std::vector<ServiceLoss> losses;
  const auto& contents = system.models[model].service_contents;
  if (contents.empty()) return losses;
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    if (step.is_beyond) continue;
    const ServiceContents& before = contents[states[at].models[model]];
    const ServiceContents& after = contents[states[at + 1].models[model]];
    const bool is_full = before.requests.size() == after.requests.size();
    if (is_full && !before.requests.empty() && gives_at_service(system, step, model, "send")) {
      losses.push_back({at, false, before.requests.front(), after.requests.back(), 1});
    }
    if (!gives_at_service(system, step, model, "answer")) continue;
    const auto answered = answered_client(before, after);
    if (!answered) continue;
    for (std::uint32_t client = 0; client < before.answers.size(); ++client) {
      const std::uint32_t expected = before.answers[client] + (client == *answered ? 1 : 0);
      if (expected <= after.answers[client]) continue;
      losses.push_back({at, true, client, *answered, expected - after.answers[client]});
    }
  }
  return losses;
}

}  // namespace maide
