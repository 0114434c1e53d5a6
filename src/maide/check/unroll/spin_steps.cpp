#include "maide/check/unroll/spin_steps.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/unroll/wire_uses.hpp"

namespace maide::program_syntax {

using Spin = syntax::Statement::Spin;

void SpinSteps::expand_spin(const Place& place, const Statement& statement, const Values& values) {
  const bool looks = statement.spin == Spin::some || statement.spin == Spin::all;
  if (!looks) return expand_callbacks(place, statement, values);
  if (*values[statement.target.index] == 0) return expand_look(place, statement, values);
  expand_found(place, statement, values);
}

void SpinSteps::expand_refused_spin(const Statement& statement) {
  const std::string text = "node " + statement.callback->node +
                           " has been added to an executor, so nothing else spins it";
  add_combined({CombinedStep::Role::step, {}, {}, "spin", 0},
               error_state(text, statement.line, statement.column), statement.line,
               statement.column);
}

void SpinSteps::expand_callbacks(const Place& place, const Statement& statement,
                                 const Values& values) {
  const FrameId leaving = behind(place.frame);
  Uses not_yet;
  if (statement.spin == Spin::until) {
    auto& spins = program_.spins_until;
    const SourcePosition position = at(statement.line, statement.column);
    const bool is_known = std::ranges::any_of(spins, [&](const SourcePosition& spin) {
      return spin.line == position.line && spin.column == position.column;
    });
    if (!is_known) spins.push_back(position);
    const std::uint32_t model = model_of(statement.model, values);
    const Service& service = names_.services.at(model);
    const Arm& arm = statement.arms.front();
    const auto taken = services_.operation_of(service, arm.output.name, false, statement.callback);
    const ModelUse use = service.rules->use(actions_, model, taken);
    not_yet.push_back(actions_.impossible(model, {use}));
    add_combined({CombinedStep::Role::step,
                  {use},
                  services_.events_of(model, "", arm.output.name),
                  service.name + "!" + arm.output.name,
                  0},
                 take(arm.output, *arm.body, leaving, arm.output.name, values), statement.line,
                 statement.column);
  }
  if (statement.spin == Spin::once) {
    // The turn may go to what no text has: parameters of a node, or one that is added.
    add_combined({CombinedStep::Role::causeless, {}, {}, "a turn that runs nothing", 0},
                 settle(leaving, values), statement.line, statement.column);
  }
  for (const SelectArm& arm : statement.select_arms) {
    if (arm.starts != nullptr) {
      expand_guarded_arm(place, arm, values, not_yet,
                         statement.spin == Spin::once ? leaving : place.frame);
      continue;
    }
    // Time goes on, whatever callbacks run meanwhile.
    const std::uint32_t fair =
        fair_group(statement.callback, arm.line, arm.column, 0, false, "timeout");
    add_combined({CombinedStep::Role::timeout, not_yet, {}, "timeout", fair},
                 settle(enter(*arm.body, leaving), values), arm.line, arm.column);
  }
}

void SpinSteps::expand_look(const Place& place, const Statement& statement, const Values& values) {
  const std::uint32_t slot = statement.target.index;
  for (const Look& look : looks_behind({{}}, statement, values)) {
    Values behind_it = values;
    behind_it[slot] = look.found == 0 ? 0 : static_cast<Value>(2 * look.found + 1);
    if (look.found == 0 && statement.counter) behind_it[*statement.counter] = 0;
    const ControlState target =
        settle(look.found == 0 ? behind(place.frame) : place.frame, behind_it);
    add_look(look, "finds nothing", statement, values, target);
  }
}

void SpinSteps::expand_found(const Place& place, const Statement& statement, const Values& values) {
  const std::uint32_t slot = statement.target.index;
  const auto left = static_cast<std::uint64_t>(*values[slot]) >> 1;
  const bool is_once = statement.spin == Spin::some;
  // Where control goes on when these are left, and so many have run.
  const auto go_on = [&](std::uint64_t rest, Value count) {
    Values behind_it = values;
    const bool is_enough = statement.counter && count == statement.upper.value;
    const bool ends = is_enough || (rest == 0 && is_once);
    behind_it[slot] = ends || rest == 0 ? 0 : static_cast<Value>(2 * rest + 1);
    if (statement.counter) behind_it[*statement.counter] = ends ? 0 : count;
    return std::pair(ends ? behind(place.frame) : place.frame, std::move(behind_it));
  };
  const Value count = statement.counter ? *values[*statement.counter] : 0;
  std::vector<Uses> passed{{}};
  for (std::size_t i = 0; i < statement.select_arms.size(); ++i) {
    const std::uint64_t bit = std::uint64_t{1} << i;
    if ((left & bit) == 0) continue;
    const std::uint64_t rest = statement.goes_by_rounds ? left & ~(2 * bit - 1) : left & ~bit;
    auto [next, behind_it] = go_on(rest, statement.counter ? count + 1 : 0);
    const SelectArm& arm = statement.select_arms[i];
    if (statement.goes_by_rounds) {
      passed = start_found(place, arm, behind_it, passed, true, next);
    } else {
      passed = actions_.combine(passed, start_found(place, arm, behind_it, {{}}, false, next));
    }
    if (passed.empty() && statement.goes_by_rounds) return;
  }
  auto [next, behind_it] = go_on(0, count);
  const ControlState target = settle(next, behind_it);
  for (const Uses& way : passed) {
    add_combined({CombinedStep::Role::look, way, {}, "has nothing more to run", 0}, target,
                 statement.line, statement.column);
  }
}

}  // namespace maide::program_syntax
