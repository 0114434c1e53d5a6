// Steps of programs with services, and of the threads that run callbacks: a callback starts, it
// ends, an executor that goes by rounds looks.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/check/build/deliveries.hpp"
#include "maide/check/build/unroller.hpp"
#include "maide/check/build/wires.hpp"

namespace maide::program_syntax {
namespace {

using Kind = ServiceModel::Operation::Kind;
constexpr std::uint32_t nobody = ~std::uint32_t{0};

// What may be due when that input was given.
ServiceModel::Operation due_behind(const ServiceModel::Operation& given) {
  if (given.kind == Kind::answer) return {Kind::answer_due, 0, 0};
  if (given.kind == Kind::receive) return {Kind::take_answer, given.client, nobody};
  return {Kind::take_request, 0, 0};
}

}  // namespace

// ---- services -----------------------------------------------------------------------------------

Unroller::ServiceUse Unroller::operation_of(const Service& service, const std::string& name,
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

std::uint32_t Unroller::caller_of(const Service& service) const {
  const auto place = std::ranges::find(service.callers, number_);
  return place == service.callers.end()
             ? 0
             : static_cast<std::uint32_t>(place - service.callers.begin());
}

Uses Unroller::events_of(std::uint32_t model, const std::string& input,
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

void Unroller::expand_service(const Place& place, const Statement& statement, const Values& values,
                              std::uint32_t model) {
  const Service& service = names_.services.at(model);
  const auto add = [&](const ServiceUse& use, const std::string& input, const std::string& output,
                       const std::string& text, ControlState target, int line, int column) {
    for (Uses& uses : ways_to_use(service, model, use, actions_)) {
      add_combined(
          {CombinedStep::Role::step, std::move(uses), events_of(model, input, output), text, 0},
          target, line, column);
    }
  };
  const std::string& input = statement.input.name;
  if (place.phase == Phase::calls) {
    const ControlState target = behind_input(place, statement, values);
    for (CombinedStep& end : ends_of_answer(service, model, caller_of(service), actions_)) {
      add_combined(std::move(end), target, statement.line, statement.column);
    }
    return;
  }
  if (place.phase == Phase::before) {
    const bool calls = input == "answer" && !service.callers.empty();
    const ControlState target = calls ? in_call(place) : behind_input(place, statement, values);
    return add(operation_of(service, input, true, statement.callback), input, "",
               service.name + "." + input, target, statement.line, statement.column);
  }
  for (const Arm& arm : statement.arms) {
    if (!arm.is_quiet) {
      const std::string& output = arm.output.name;
      add(operation_of(service, output, false, statement.callback), "", output,
          service.name + "!" + output,
          take(arm.output, *arm.body, behind(place.frame), output, values), arm.line, arm.column);
      continue;
    }
    const ServiceUse given = operation_of(service, input, true, statement.callback);
    const ModelUse due = service.rules->use(actions_, model, due_behind(given));
    add_combined({CombinedStep::Role::step, {actions_.impossible(model, {due})}, {}, "quiet", 0},
                 settle(enter(*arm.body, behind(place.frame)), values), arm.line, arm.column);
  }
}

Unroller::ServiceArm Unroller::service_arm(const SelectArm& arm, std::uint32_t model) const {
  const Service& service = names_.services.at(model);
  const std::string& name = arm.event.name;
  if (arm.kind == SelectArm::Kind::output) {
    return {operation_of(service, name, false, arm.callback), name, std::nullopt};
  }
  ServiceArm way{operation_of(service, name, true, arm.callback), std::nullopt, std::nullopt};
  const ServiceUse given = way.use;
  way.due = due_behind(given);
  if (arm.body) return way;
  const std::string& output = arm.arms.front().output.name;
  const bool follows =
      arm.arms.size() == 1 &&
      ((given.kind == Kind::serve && output == "request") ||
       (given.kind == Kind::receive && output == name_at_client("answer", given.client)));
  if (!follows) {
    throw ParseError("this arm's outputs never follow " + service.name + "." + name + " at once",
                     at(arm.line, arm.column));
  }
  way.use.kind = given.kind == Kind::serve ? Kind::serve_at_once : Kind::receive_at_once;
  way.output = output;
  return way;
}

// ---- callbacks ----------------------------------------------------------------------------------

std::pair<Uses, Uses> Unroller::start_of(const SelectArm& arm) {
  const Callback& callback = *arm.starts;
  if (callback.kind == Callback::Kind::timer) return {};
  const Service& service = names_.services.at(callback.model);
  if (callback.kind == Callback::Kind::service) {
    return {{service.rules->use(actions_, callback.model, {Kind::serve_at_once, 0, callback.run})},
            events_of(callback.model, "serve", "request")};
  }
  const std::uint32_t client = service.client_of(callback.node, number_).value_or(0);
  const bool has_code = callback.code != nullptr;
  const Kind kind = has_code ? Kind::take_own : Kind::hand_over;
  return {{service.rules->use(actions_, callback.model, {kind, client, nobody})},
          events_of(callback.model, name_at_client("receive", client),
                    has_code ? name_at_client("answer", client) : "")};
}

ModelUse Unroller::discard_of(const SelectArm& arm) {
  const Callback& callback = *arm.starts;
  const Service& service = names_.services.at(callback.model);
  const std::uint32_t client = service.client_of(callback.node, number_).value_or(0);
  return service.rules->use(actions_, callback.model, {Kind::take_others, client, nobody});
}

void Unroller::expand_discard(const Place& place, const SelectArm& arm, const Values& values,
                              const Uses& conditions) {
  if (arm.starts->kind != Callback::Kind::client) return;
  const bool is_one = names_.services.at(arm.starts->model).takes_one_by_one;
  for (Uses& way : combine({{discard_of(arm)}}, {conditions})) {
    add_combined({CombinedStep::Role::discard,
                  std::move(way),
                  {},
                  arm.starts->whole_name() + " throws away " +
                      (is_one ? "an answer to another" : "answers to others"),
                  0,
                  arm.starts->number},
                 settle(place.frame, values), arm.line, arm.column);
  }
}

std::vector<Uses> Unroller::nothing_for(const SelectArm& arm, const Values& values) {
  if (arm.starts->kind != Callback::Kind::subscription) {
    const std::uint32_t service = arm.starts->model;
    Uses taking = start_of(arm).first;
    if (arm.starts->kind == Callback::Kind::client) taking.push_back(discard_of(arm));
    return {{actions_.impossible(service, taking)}};
  }
  const std::uint32_t model = model_of(arm.model, values);
  Uses taking;
  if (arm.kind == SelectArm::Kind::input) {
    for (const InputWay& way : ways_of(arm, model, input_of(model, arm.event, values))) {
      taking.push_back(way.uses.front());
    }
  } else {
    const Alphabet& outputs = actions_.model(model).automaton.outputs();
    for (Symbol output = 0; output < outputs.size(); ++output) {
      const std::string& name = outputs.name(output);
      if (!matches(arm.event, split_name(name), name, values)) continue;
      taking.push_back({ModelUse::Kind::take, model, output});
    }
  }
  return {{actions_.impossible(model, taking)}};
}

std::pair<std::vector<Uses>, std::vector<Uses>> Unroller::asked(const SelectArm& arm,
                                                                const Values& values) {
  std::vector<Uses> nothing = nothing_for(arm, values);
  const ModelUse& none = nothing.front().front();
  return {{{actions_.impossible(none.model, {none})}}, nothing};
}

std::vector<std::size_t> Unroller::order_of_look(const Statement& statement,
                                                 const Values& values) const {
  bool is_one_by_one = false, is_late = false;
  std::vector<std::size_t> order;
  for (const CallbackKind kind :
       {CallbackKind::subscription, CallbackKind::client, CallbackKind::service}) {
    for (std::size_t i = 0; i < statement.select_arms.size(); ++i) {
      const SelectArm& arm = statement.select_arms[i];
      if (arm.starts->kind != kind) continue;
      order.push_back(i);
      if (kind == CallbackKind::subscription) {
        const std::uint32_t model = model_of(arm.model, values);
        is_one_by_one = is_one_by_one || is_over_fast_dds(actions_.model(model));
        is_late = is_late || names_.wires.contains(model);
      } else {
        const Service& service = names_.services.at(arm.starts->model);
        is_one_by_one = is_one_by_one || service.takes_one_by_one;
        is_late = is_late || is_on_its_way(service);
      }
    }
  }
  if (!is_one_by_one || !is_late) order.clear();
  return order;
}

void Unroller::expand_rounds(const Place& place, const Statement& statement, const Values& values) {
  const std::uint32_t slot = statement.target.index;
  const std::size_t count = statement.select_arms.size();
  const auto value = static_cast<std::uint64_t>(*values[slot]);
  const std::uint64_t left = value & ((std::uint64_t{1} << count) - 1);
  if (left != value) return go_on_looking(place, statement, values, left, value >> count);
  // The first of those that the last look found starts; what has nothing any more is passed over.
  std::vector<Uses> passed{{}};
  for (std::size_t i = 0; i < count; ++i) {
    if ((left >> i & 1) == 0) continue;
    const SelectArm& arm = statement.select_arms[i];
    Values behind_it = values;
    behind_it[slot] = static_cast<Value>(left & ~((std::uint64_t{2} << i) - 1));
    for (const Uses& conditions : passed) {
      expand_arm(place, arm, behind_it, conditions, 0);
      expand_discard(place, arm, behind_it, conditions);
    }
    if (arm.starts->kind == Callback::Kind::timer) return;
    passed = combine(passed, nothing_for(arm, values));
  }
  const std::vector<std::size_t> order = order_of_look(statement, values);
  const std::size_t asked_first = order.empty() ? count : 1;  // in this step
  // By which callbacks there is something for: each of some ways.
  struct Look {
    std::vector<Uses> ways;
    std::uint64_t found = 0;
    std::string text;
  };
  std::vector<Look> looks{{std::move(passed), 0, ""}};
  std::uint64_t timers = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const SelectArm& arm = statement.select_arms[i];
    const bool is_timer = arm.starts->kind == Callback::Kind::timer;
    if (is_timer) timers |= std::uint64_t{1} << i;
    if (!is_timer && !order.empty() && order.front() != i) continue;
    std::vector<Uses> nothing{{}}, something{{}};
    if (!is_timer) std::tie(something, nothing) = asked(arm, values);
    std::vector<Look> next;
    for (const Look& look : looks) {
      next.push_back({combine(look.ways, nothing), look.found, look.text});
      next.push_back({combine(look.ways, something), look.found | std::uint64_t{1} << i,
                      look.text + (look.text.empty() ? "" : ", ") + arm.starts->whole_name()});
    }
    looks = std::move(next);
  }
  for (Look& look : looks) {
    if (look.found == 0) {
      // Something is there that is asked for later, or nobody looks.
      std::vector<Uses> there, before = std::move(look.ways);
      for (std::size_t i = asked_first; i < order.size(); ++i) {
        const auto [something, nothing] = asked(statement.select_arms[order[i]], values);
        for (Uses& way : combine(before, something)) there.push_back(std::move(way));
        before = combine(before, nothing);
      }
      look.ways = std::move(there);
    }
    Values behind_it = values;
    const std::uint64_t still = order.size() > asked_first ? asked_first << count : 0;
    behind_it[slot] = static_cast<Value>(look.found | still);
    if (look.ways.empty()) continue;
    const ControlState target = settle(place.frame, behind_it);
    // On fair runs each timer is due again and again, alone and together with others.
    std::uint32_t fair = 0;
    if (timers != 0) {
      fair = fair_group(nullptr, statement.line, statement.column,
                        static_cast<Value>(look.found & timers), false, "a look");
    }
    for (const Uses& way : look.ways) {
      add_combined({CombinedStep::Role::look,
                    way,
                    {},
                    look.found == 0 ? "looks" : "finds " + look.text,
                    fair},
                   target, statement.line, statement.column);
    }
  }
}

void Unroller::go_on_looking(const Place& place, const Statement& statement, const Values& values,
                             std::uint64_t found, std::size_t asked_so_far) {
  const std::size_t count = statement.select_arms.size();
  const std::vector<std::size_t> order = order_of_look(statement, values);
  const std::size_t next = order[asked_so_far];
  const SelectArm& arm = statement.select_arms[next];
  const std::uint64_t still = asked_so_far + 1 < order.size() ? (asked_so_far + 1) << count : 0;
  const auto [something, nothing] = asked(arm, values);
  const auto add = [&](const std::vector<Uses>& ways, std::uint64_t all, const std::string& text) {
    Values behind_it = values;
    behind_it[statement.target.index] = static_cast<Value>(all | still);
    const ControlState target = settle(place.frame, behind_it);
    for (const Uses& way : ways) {
      add_combined({CombinedStep::Role::look, way, {}, text, 0}, target, statement.line,
                   statement.column);
    }
  };
  add(nothing, found, "finds nothing for " + arm.starts->whole_name());
  add(something, found | std::uint64_t{1} << next, "finds " + arm.starts->whole_name());
}

void Unroller::expand_end(const Place& place, const Statement& statement, const Values& values) {
  const Callback& callback = *statement.callback;
  Uses uses = callback.end;
  for (const std::uint32_t model : statement.services) {
    const Service& service = names_.services.at(model);
    const auto client = service.client_of(callback.node, number_);
    if (!client || service.own_code.contains(callback.node)) continue;
    uses.push_back(service.rules->use(actions_, model, {Kind::end_run, *client, callback.asker}));
  }
  add_combined({CombinedStep::Role::end, std::move(uses), {}, callback.whole_name() + " ends", 0},
               settle(behind(place.frame), values), statement.line, statement.column);
}

}  // namespace maide::program_syntax
