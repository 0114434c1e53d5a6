#include "maide/check/unroll/look_steps.hpp"

#include <string>
#include <tuple>

#include "maide/check/rules/system_options.hpp"
#include "maide/check/unroll/wire_uses.hpp"

namespace maide::program_syntax {

void LookSteps::expand_discard(const SelectArm& arm, const Values& values, const Uses& conditions,
                               FrameId next) {
  if (arm.starts->kind != Callback::Kind::client) return;
  const bool is_one = names_.services.at(arm.starts->model).takes_one_by_one;
  for (Uses& way : actions_.combine({{services_.discard_of(*arm.starts)}}, {conditions})) {
    add_combined({CombinedStep::Role::discard,
                  std::move(way),
                  {},
                  arm.starts->whole_name() + " throws away " +
                      (is_one ? "an answer to another" : "answers to others"),
                  0,
                  arm.starts->number},
                 settle(next, values), arm.line, arm.column);
  }
}

std::vector<Uses> LookSteps::nothing_for(const SelectArm& arm, const Values& values) {
  if (arm.starts->kind != Callback::Kind::subscription) {
    const std::uint32_t service = arm.starts->model;
    Uses taking = services_.start_of(*arm.starts).first;
    if (arm.starts->kind == Callback::Kind::client)
      taking.push_back(services_.discard_of(*arm.starts));
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

std::pair<std::vector<Uses>, std::vector<Uses>> LookSteps::may_start(
    const SelectArm& arm, const Values& values, const std::vector<Uses>& passed) {
  if (!arm.guard) return {{{}}, {}};
  std::pair<std::vector<Uses>, std::vector<Uses>> ways;
  for (auto& [conditions, result] : outcomes(*arm.guard, values, at(arm.line, arm.column))) {
    const Uses uses = actions_.variables(conditions, {});
    if (result.value) {
      (*result.value != 0 ? ways.first : ways.second).push_back(uses);
      continue;
    }
    const ControlState error = error_state(result.error, result.line, result.column);
    for (Uses& way : actions_.combine(passed, {uses})) {
      add_combined({CombinedStep::Role::arm, std::move(way), {}, "when", 0}, error, arm.line,
                   arm.column);
    }
  }
  return ways;
}

std::pair<std::vector<Uses>, std::vector<Uses>> LookSteps::asked(const SelectArm& arm,
                                                                 const Values& values) {
  std::vector<Uses> nothing = nothing_for(arm, values);
  const ModelUse none = nothing.front().front();
  if (may_be_missed(arm, values)) nothing = {{}};  // the look may be too early
  return {{{actions_.impossible(none.model, {none})}}, nothing};
}

std::vector<std::size_t> LookSteps::order_of_look(const Statement& statement,
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

std::vector<LookSteps::Look> LookSteps::looks_behind(std::vector<Uses> passed,
                                                     const Statement& statement,
                                                     const Values& values,
                                                     std::optional<std::size_t> only) {
  std::vector<Look> looks{{std::move(passed), 0, ""}};
  for (std::size_t i = 0; i < statement.select_arms.size(); ++i) {
    const SelectArm& arm = statement.select_arms[i];
    if (arm.starts == nullptr) continue;
    if (arm.came && *values[arm.came->index] != 0) continue;  // it is not due any more
    const bool is_timer = arm.starts->kind == Callback::Kind::timer;
    if (!is_timer && only && *only != i) continue;
    std::vector<Uses> nothing{{}}, something{{}};
    if (!is_timer) std::tie(something, nothing) = asked(arm, values);
    std::vector<Look> next;
    for (const Look& look : looks) {
      next.push_back({actions_.combine(look.ways, nothing), look.found, look.text});
      next.push_back({actions_.combine(look.ways, something), look.found | std::uint64_t{1} << i,
                      look.text + (look.text.empty() ? "" : ", ") + arm.starts->whole_name()});
    }
    looks = std::move(next);
  }
  return looks;
}

std::uint32_t LookSteps::fair_look(const Statement& statement, const Values& values,
                                   std::uint64_t found) {
  std::uint64_t sure = 0, unsure = 0;
  for (std::size_t i = 0; i < statement.select_arms.size(); ++i) {
    const SelectArm& arm = statement.select_arms[i];
    if (arm.starts == nullptr || (arm.came && *values[arm.came->index] != 0)) continue;
    const bool is_timer = arm.starts->kind == Callback::Kind::timer;
    if (!is_timer && !may_be_missed(arm, values)) continue;
    (awaits_anybody(arm, values) ? unsure : sure) |= std::uint64_t{1} << i;
  }
  if (sure == 0 && unsure == 0) return 0;
  // Of what need not come all is found together, or nothing.
  const bool is_some = (found & unsure) != 0 && (found & unsure) != unsure;
  if (is_some) return 0;
  return fair_group(nullptr, statement.line, statement.column,
                    static_cast<Value>(found & (sure | unsure)), false, "a look");
}

bool LookSteps::may_be_missed(const SelectArm& arm, const Values& values) {
  switch (arm.starts->kind) {
    case Callback::Kind::subscription: return is_left_to_anybody(model_of(arm.model, values));
    case Callback::Kind::service: return names_.services.at(arm.starts->model).is_open;
    case Callback::Kind::client: return names_.services.at(arm.starts->model).is_server_anybody;
    default: return false;
  }
}

bool LookSteps::awaits_anybody(const SelectArm& arm, const Values& values) {
  switch (arm.starts->kind) {
    case Callback::Kind::subscription:
      return actions_.model(model_of(arm.model, values)).awaits_anybody;
    case Callback::Kind::service: return actions_.model(arm.starts->model).awaits_anybody;
    default: return false;
  }
}

void LookSteps::add_look(const Look& look, const std::string& if_nothing,
                         const Statement& statement, const Values& values, ControlState target) {
  const std::uint32_t fair = fair_look(statement, values, look.found);
  bool awaits = false;
  for (std::size_t i = 0; i < statement.select_arms.size(); ++i) {
    const bool is_found = (look.found >> i & 1) != 0;
    awaits = awaits || (is_found && awaits_anybody(statement.select_arms[i], values));
  }
  for (const Uses& way : look.ways) {
    CombinedStep step{CombinedStep::Role::look,
                      way,
                      {},
                      look.found == 0 ? if_nothing : "finds " + look.text,
                      fair};
    step.awaits_anybody = awaits;
    add_combined(std::move(step), target, statement.line, statement.column);
  }
}

std::vector<Uses> LookSteps::start_found(const Place& place, const SelectArm& arm,
                                         const Values& values, const std::vector<Uses>& passed,
                                         bool discards, FrameId next) {
  const auto [may, may_not] = may_start(arm, values, passed);
  const std::vector<Uses> ways = actions_.combine(passed, may);
  was_found_ = true;
  for (const Uses& conditions : ways) {
    expand_arm(place, arm, values, conditions, 0, next);
    if (discards) expand_discard(arm, values, conditions, next);
  }
  was_found_ = false;
  const bool is_timer = arm.starts->kind == Callback::Kind::timer;
  if (is_timer && may_not.empty()) return {};
  std::vector<Uses> behind = actions_.combine(passed, may_not);
  if (is_timer) return behind;
  for (Uses& way : actions_.combine(ways, nothing_for(arm, values)))
    behind.push_back(std::move(way));
  return behind;
}

void LookSteps::expand_rounds(const Place& place, const Statement& statement,
                              const Values& values) {
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
    passed = start_found(place, arm, behind_it, passed, true, behind(place.frame));
    const bool is_timer = arm.starts->kind == Callback::Kind::timer;
    if (is_timer && passed.empty()) return;
  }
  const std::vector<std::size_t> order = order_of_look(statement, values);
  const std::size_t asked_first = order.empty() ? count : 1;  // in this step
  std::optional<std::size_t> only;
  if (!order.empty()) only = order.front();
  for (Look& look : looks_behind(std::move(passed), statement, values, only)) {
    if (look.found == 0) {
      // Something is there that is asked for later, or nobody looks.
      std::vector<Uses> there, before = std::move(look.ways);
      for (std::size_t i = asked_first; i < order.size(); ++i) {
        const auto [something, nothing] = asked(statement.select_arms[order[i]], values);
        for (Uses& way : actions_.combine(before, something)) there.push_back(std::move(way));
        before = actions_.combine(before, nothing);
      }
      look.ways = std::move(there);
    }
    Values behind_it = values;
    const std::uint64_t still = order.size() > asked_first ? asked_first << count : 0;
    behind_it[slot] = static_cast<Value>(look.found | still);
    if (look.ways.empty()) continue;
    const ControlState target = settle(place.frame, behind_it);
    add_look(look, "looks", statement, values, target);
  }
}

void LookSteps::go_on_looking(const Place& place, const Statement& statement, const Values& values,
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

}  // namespace maide::program_syntax
