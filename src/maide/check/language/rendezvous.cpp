// Steps of a program with its models: an input that is given, an output that is taken.
#include <string>
#include <utility>
#include <vector>

#include "maide/check/language/unroller.hpp"

namespace maide::program_syntax {

void Unroller::expand_rendezvous(const Place& place, const Statement& statement,
                                 const Values& values) {
  const std::uint32_t model = model_of(statement.model, values);
  if (names_.services.contains(model)) return expand_service(place, statement, values, model);
  using Kind = ModelUse::Kind;
  if (place.phase == Phase::before) {
    const Symbol input = input_of(model, statement.input, values);
    const ControlState target =
        statement.arms.empty()
            ? settle(behind(place.frame), values)
            : control_state({place.frame, Phase::awaits, 0, place.valuation, 0, 0});
    if (const Topic* topic = written_topic(statement.model, statement.input.name, values)) {
      const std::string name = name_of(statement.input, values);
      for (const Writing& way : writings(*topic, name, WriteKind::statement)) {
        add_joint({Joint::Role::step, way.uses, way.events, topic->name + "." + name, 0}, target,
                  statement.line, statement.column);
      }
      return;
    }
    return add_edge({Kind::give, model, input}, target, statement.line, statement.column);
  }
  const std::vector<const Arm*> taken = arms_of(model, statement.arms, values);
  const Alphabet& outputs = actions_.model(model).automaton.outputs();
  for (const Arm& arm : statement.arms) {
    if (arm.is_quiet) {
      const ControlState target = settle(enter(*arm.body, behind(place.frame)), values);
      if (const Topic* topic = written_topic(statement.model, statement.input.name, values)) {
        for (Uses& uses : quiet_of(*topic)) {
          add_joint({Joint::Role::step, std::move(uses), {}, "quiet", 0}, target, arm.line,
                    arm.column);
        }
      } else {
        add_edge({Kind::quiet, model, 0}, target, arm.line, arm.column);
      }
      continue;
    }
    const Topic* topic = written_topic(statement.model, arm.output.name, values);
    for (Symbol output = 0; output < outputs.size(); ++output) {
      if (taken[output] != &arm) continue;
      const std::string& name = outputs.name(output);
      const ControlState target = take(arm.output, *arm.body, behind(place.frame), name, values);
      if (topic == nullptr) {
        add_edge({Kind::take, model, output}, target, arm.line, arm.column);
      } else {
        for (Taking& way : takings(*topic)) {
          if (way.output != name) continue;
          add_joint({Joint::Role::step, std::move(way.uses), std::move(way.events),
                     topic->name + "!" + name, 0},
                    target, arm.line, arm.column);
        }
      }
    }
  }
}

}  // namespace maide::program_syntax
