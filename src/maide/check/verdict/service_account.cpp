#include "maide/check/verdict/service_account.hpp"

#include <algorithm>
#include <iterator>
#include <span>

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

// The client at whose end one of the events is that of the model: "send" stands for "send2", too.
std::optional<std::uint32_t> client_at(const ModelInstance& service,
                                       std::span<const ModelUse> events, const ModelUse& how,
                                       const std::string& what) {
  const bool gives = how.kind == ModelUse::Kind::give;
  const Alphabet& symbols = gives ? service.automaton.inputs() : service.automaton.outputs();
  const std::size_t clients = service.service_contents.front().answers.size();
  for (const ModelUse& event : events) {
    if (event.kind != how.kind || event.model != how.model) continue;
    for (std::uint32_t client = 0; client < clients; ++client) {
      if (symbols.name(event.index) == name_at_client(what, client)) return client;
    }
  }
  return std::nullopt;
}

// By client: what comes as that event is on its way for a while before.
std::vector<bool> late_clients(const System& system, const ModelUse& take,
                               const std::string& arrival) {
  const ModelInstance& service = system.models[take.model];
  std::vector<bool> is_late(service.service_contents.front().answers.size());
  for (const NobodysAction& action : system.nobodys_actions) {
    const auto client = client_at(service, action.what.events, take, arrival);
    if (client) is_late[*client] = true;
  }
  return is_late;
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

std::vector<ServiceLoss> find_service_losses(const System& system, const Trace& trace,
                                             const std::vector<GlobalState>& states,
                                             std::uint32_t model) {
  MAIDE_CHECK(states.size() == trace.steps.size() + 1);
  std::vector<ServiceLoss> losses;
  const auto& contents = system.models[model].service_contents;
  if (contents.empty()) return losses;
  const ModelUse give{ModelUse::Kind::give, model, 0}, take{ModelUse::Kind::take, model, 0};
  const std::vector<bool> is_asked_late = late_clients(system, take, "request_arrives");
  const std::vector<bool> is_answered_late = late_clients(system, take, "answer_arrives");
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    if (step.is_beyond) continue;
    const ServiceContents& before = contents[states[at].models[model]];
    const ServiceContents& after = contents[states[at + 1].models[model]];
    const auto add_lost_answers = [&](std::uint32_t client, std::uint32_t more,
                                      std::optional<std::uint32_t> by) {
      const std::uint32_t expected = before.answers[client] + more;
      if (expected <= after.answers[client]) return;
      losses.push_back({at, true, client, by, expected - after.answers[client]});
    };
    const auto client_of = [&](const ModelUse& how, const std::string& what) {
      return client_at(system.models[model], events_of(system, step), how, what);
    };
    const auto sender = client_of(give, "send");
    const bool request_comes =
        (sender && !is_asked_late[*sender]) || client_of(take, "request_arrives");
    const bool is_full = before.requests.size() == after.requests.size();
    if (request_comes && is_full && !before.requests.empty()) {
      losses.push_back({at, false, before.requests.front(), after.requests.back(), 1});
    }
    if (const auto client = client_of(take, "answer_arrives")) {
      const bool is_own = before.coming[*client] > after.coming[*client];
      const bool is_of_two = before.answers.size() == 2;
      add_lost_answers(*client, is_own ? 1 : 0,
                       is_own      ? client
                       : is_of_two ? std::optional(1 - *client)
                                   : std::nullopt);
    }
    if (!client_of(give, "answer")) continue;
    const auto answered = answered_client(before, after);
    if (!answered) continue;
    for (std::uint32_t client = 0; client < before.answers.size(); ++client) {
      if (!is_answered_late[client])
        add_lost_answers(client, client == *answered ? 1 : 0, answered);
    }
  }
  return losses;
}

}  // namespace maide
