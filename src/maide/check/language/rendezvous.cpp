// Steps of a program with its models: an input that is given, an output that is taken. On a topic a
// writer's step is one with the models of all readers.
#include <string>
#include <utility>
#include <vector>

#include "maide/check/language/unroller.hpp"

namespace maide::program_syntax {

void Unroller::expand_rendezvous(const Place& place, const Statement& statement,
                                 const Values& values) {
  const std::uint32_t model = model_of(statement.model, values);
  using Kind = ModelUse::Kind;
  if (place.phase == Phase::before) {
    const Symbol input = input_of(model, statement.input, values);
    const ControlState target =
        statement.arms.empty()
            ? settle(behind(place.frame), values)
            : control_state({place.frame, Phase::awaits, 0, place.valuation, 0, 0});
    if (const Topic* topic = written_topic(statement.model, statement.input.name, values)) {
      return add_write(*topic, statement, name_of(statement.input, values), target);
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
        add_taking(*topic, arm, name, target);
      }
    }
  }
}

// ---- topics -------------------------------------------------------------------------------------

Uses Unroller::events_of(const Topic& topic, ModelUse::Kind kind, const std::string& name,
                         const Topic::Reader* only) const {
  Uses events;
  for (const Topic::Reader& reader : topic.readers) {
    if (only != nullptr && only != &reader) continue;
    const InterfaceAutomaton& automaton = actions_.model(reader.model).automaton;
    const Alphabet& alphabet =
        kind == ModelUse::Kind::give ? automaton.inputs() : automaton.outputs();
    if (const auto symbol = alphabet.find(name)) events.push_back({kind, reader.model, *symbol});
  }
  return events;
}

void Unroller::add_write(const Topic& topic, const Statement& statement, const std::string& input,
                         ControlState target) {
  const std::string text = topic.name + "." + input;
  if (!topic.delivers_one) {
    const Uses uses = events_of(topic, ModelUse::Kind::give, input);
    if (uses.size() < topic.readers.size()) return;  // a model does not know it
    return add_joint({Joint::Role::step, uses, uses, text, 0}, target, statement.line,
                     statement.column);
  }
  for (const Topic::Reader& reader : topic.readers) {
    Uses events = events_of(topic, ModelUse::Kind::give, input, &reader);
    if (events.empty()) continue;
    Uses uses = events;
    for (const Topic::Reader& other : topic.readers) {
      if (&other == &reader) continue;
      uses.push_back(actions_.collected(other, SharedActions::Collected::nothing, false));
    }
    add_joint({Joint::Role::step, std::move(uses), std::move(events), text, 0}, target,
              statement.line, statement.column);
  }
}

void Unroller::add_taking(const Topic& topic, const Arm& arm, const std::string& output,
                          ControlState target) {
  using Collected = SharedActions::Collected;
  const bool has_failed = output.starts_with("failed");
  for (std::size_t first = 0; first < topic.readers.size(); ++first) {
    const Topic::Reader& reader = topic.readers[first];
    const InterfaceAutomaton& automaton = actions_.model(reader.model).automaton;
    const auto symbol = automaton.outputs().find(output);
    if (!symbol) continue;
    Uses uses{actions_.collected(reader, *symbol)};
    for (std::size_t i = 0; i < topic.readers.size(); ++i) {
      if (i == first) continue;
      if (topic.delivers_one) {
        uses.push_back(actions_.collected(topic.readers[i], Collected::nothing, false));
      } else {
        const bool may_fail = has_failed && i > first;  // this is the first one that failed
        uses.push_back(actions_.collected(
            topic.readers[i], may_fail ? Collected::something : Collected::written, true));
      }
    }
    add_joint({Joint::Role::step, std::move(uses), events_of(topic, ModelUse::Kind::take, output),
               topic.name + "!" + output, 0},
              target, arm.line, arm.column);
    if (!has_failed && !topic.delivers_one) break;
  }
}

std::vector<Uses> Unroller::quiet_of(const Topic& topic) {
  using Collected = SharedActions::Collected;
  std::vector<Uses> result;
  for (std::size_t first = 0; first < topic.readers.size(); ++first) {
    Uses uses;
    for (std::size_t i = 0; i < topic.readers.size(); ++i) {
      const Topic::Reader& reader = topic.readers[i];
      if (i == first || topic.delivers_one) {
        uses.push_back(actions_.collected(reader, Collected::nothing, false, true));
      } else if (i < first) {
        uses.push_back(actions_.collected(reader, Collected::something, false, true));
      } else {
        uses.push_back({ModelUse::Kind::quiet, reader.model, 0});
      }
    }
    result.push_back(std::move(uses));
    if (topic.delivers_one) break;
  }
  return result;
}

}  // namespace maide::program_syntax
