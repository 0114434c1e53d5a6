#include "maide/check/unroll/service_steps.hpp"

#include <algorithm>

namespace maide::program_syntax {
namespace {

using Kind = ServiceModel::Operation::Kind;
constexpr std::uint32_t nobody = ~std::uint32_t{0};

}  // namespace

ServiceSteps::Operation ServiceSteps::due_behind(const Operation& given) {
  if (given.kind == Kind::answer) return {Kind::answer_due, 0, 0};
  if (given.kind == Kind::receive) return {Kind::own_answer_due, given.client, nobody};
  return {Kind::take_request, 0, 0};
}

ServiceSteps::Operation ServiceSteps::operation_of(const Service& service, const std::string& name,
                                                   bool is_input, const Callback* callback) const {
  const bool serves = callback != nullptr && callback->kind == Callback::Kind::service;
  const std::uint32_t server_run = serves ? callback->run : 0;
  if (name == "serve") return {Kind::serve, 0, 0};
  if (name == "request") return {Kind::take_request, 0, 0};
  if (is_input && name == "answer") return {Kind::answer, 0, server_run, caller_of(service)};
  const std::string node = callback != nullptr ? callback->node : "";
  const std::uint32_t client = service.client_of(node, number_).value_or(0);
  // Where the client has code of its own, no callback waits for what it asked.
  const bool may_wait = callback != nullptr && !service.own_code.contains(node);
  const std::uint32_t run = may_wait ? callback->asker : nobody;
  if (!is_input) return {callback != nullptr ? Kind::wait : Kind::take_answer, client, run};
  const bool sends = name == name_at_client("send", client);
  return {sends ? Kind::send : Kind::receive, client, run};
}

std::uint32_t ServiceSteps::caller_of(const Service& service) const {
  const auto place = std::ranges::find(service.callers, number_);
  return place == service.callers.end()
             ? 0
             : static_cast<std::uint32_t>(place - service.callers.begin());
}

Uses ServiceSteps::events_of(std::uint32_t model, const std::string& input,
                             const std::string& output) const {
  const InterfaceAutomaton& automaton = actions_.model(model).automaton;
  Uses events;
  if (const auto symbol = automaton.inputs().find(input)) {
    events.push_back({ModelUse::Kind::give, model, *symbol});
  }
  if (const auto symbol = automaton.outputs().find(output)) {
    events.push_back({ModelUse::Kind::take, model, *symbol});
  }
  return events;
}

ServiceSteps::Arm ServiceSteps::arm(const SelectArm& arm, std::uint32_t model,
                                    const SourcePosition& position) const {
  const Service& service = names_.services.at(model);
  const std::string& name = arm.event.name;
  if (arm.kind == SelectArm::Kind::output) {
    return {operation_of(service, name, false, arm.callback), name, std::nullopt};
  }
  Arm way{operation_of(service, name, true, arm.callback), std::nullopt, std::nullopt};
  const Operation given = way.use;
  way.due = due_behind(given);
  if (arm.body) return way;
  const std::string& output = arm.arms.front().output.name;
  const bool follows =
      arm.arms.size() == 1 &&
      ((given.kind == Kind::serve && output == "request") ||
       (given.kind == Kind::receive && output == name_at_client("answer", given.client)));
  if (!follows) {
    throw ParseError("this arm's outputs never follow " + service.name + "." + name + " at once",
                     position);
  }
  way.use.kind = given.kind == Kind::serve ? Kind::serve_at_once : Kind::receive_at_once;
  way.output = output;
  return way;
}

std::optional<ModelUse> ServiceSteps::time_out_of(const SelectArm& arm, std::uint32_t model) const {
  const auto service = names_.services.find(model);
  if (service == names_.services.end()) return std::nullopt;
  const Operation given = operation_of(service->second, arm.event.name, true, arm.callback);
  if (given.kind != Kind::receive) return std::nullopt;
  return service->second.rules->use(actions_, model, {Kind::time_out, given.client, nobody});
}

// ---- callbacks ----------------------------------------------------------------------------------

std::pair<Uses, Uses> ServiceSteps::start_of(const Callback& callback) const {
  if (callback.kind != Callback::Kind::service && callback.kind != Callback::Kind::client)
    return {};
  const Service& service = names_.services.at(callback.model);
  if (callback.kind == Callback::Kind::service) {
    return {{service.rules->use(actions_, callback.model, {Kind::serve_at_once, 0, callback.run})},
            events_of(callback.model, "serve", "request")};
  }
  const std::uint32_t client = service.client_of(callback.node, number_).value_or(0);
  const bool has_code = callback.code != nullptr;
  const bool is_for_code = service.own_code.contains(callback.node);
  const Kind kind = is_for_code ? Kind::take_own : Kind::hand_over;
  return {{service.rules->use(actions_, callback.model, {kind, client, nobody})},
          events_of(callback.model, name_at_client("receive", client),
                    has_code ? name_at_client("answer", client) : "")};
}

ModelUse ServiceSteps::discard_of(const Callback& callback) const {
  const Service& service = names_.services.at(callback.model);
  const std::uint32_t client = service.client_of(callback.node, number_).value_or(0);
  return service.rules->use(actions_, callback.model, {Kind::take_others, client, nobody});
}

}  // namespace maide::program_syntax
