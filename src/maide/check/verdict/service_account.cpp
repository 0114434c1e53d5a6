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

// The client at whose end the step does that with the model: "send" stands for "send2", too.
std::optional<std::uint32_t> client_at(const System& system, const Step& step, const ModelUse& how,
                                       const std::string& what) {
  const InterfaceAutomaton& automaton = system.models[how.model].automaton;
  const Alphabet& symbols =
      how.kind == ModelUse::Kind::give ? automaton.inputs() : automaton.outputs();
  for (const ModelUse& event : events_of(system, step)) {
    if (event.kind != how.kind || event.model != how.model) continue;
    const std::string& name = symbols.name(event.index);
    if (!is_numbered(name, what)) continue;
    for (std::uint32_t client = 0;; ++client) {
      if (name_at_client(what, client) == name) return client;
    }
  }
  return std::nullopt;
}

// By client: its requests and answers are on their way for a while.
std::vector<bool> late_clients(const System& system, std::uint32_t model) {
  std::vector<bool> is_late(system.models[model].service_contents.front().answers.size());
  for (std::uint32_t number = 0; number < system.nobodys_actions.size(); ++number) {
    Step step;
    step.actor = nobody;
    step.action = number;
    const auto client =
        client_at(system, step, {ModelUse::Kind::take, model, 0}, "request_arrives");
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
  const std::vector<bool> is_late = late_clients(system, model);
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
    const auto sender = client_at(system, step, {ModelUse::Kind::give, model, 0}, "send");
    const bool request_comes =
        (sender && !is_late[*sender]) ||
        client_at(system, step, {ModelUse::Kind::take, model, 0}, "request_arrives");
    const bool is_full = before.requests.size() == after.requests.size();
    if (request_comes && is_full && !before.requests.empty()) {
      losses.push_back({at, false, before.requests.front(), after.requests.back(), 1});
    }
    if (const auto client =
            client_at(system, step, {ModelUse::Kind::take, model, 0}, "answer_arrives")) {
      const bool is_own = before.coming[*client] > after.coming[*client];
      const bool is_of_two = before.answers.size() == 2;
      add_lost_answers(*client, is_own ? 1 : 0,
                       is_own      ? client
                       : is_of_two ? std::optional(1 - *client)
                                   : std::nullopt);
    }
    if (!gives_at_service(system, step, model, "answer")) continue;
    const auto answered = answered_client(before, after);
    if (!answered) continue;
    for (std::uint32_t client = 0; client < before.answers.size(); ++client) {
      if (!is_late[client]) add_lost_answers(client, client == *answered ? 1 : 0, answered);
    }
  }
  return losses;
}

}  // namespace maide
