#include "maide/automata/moore.hpp"

#include <map>
#include <utility>

namespace maide {

std::optional<std::string> find_initial_output(const Mealy& machine) {
  const auto type = machine.origin.find("type");
  if (type == machine.origin.end() || (type->second != "moore" && type->second != "dfa")) {
    return std::nullopt;
  }
  const auto output = machine.origin.find("initial_output");
  if (output == machine.origin.end()) return std::nullopt;
  return output->second;
}

void mark_as_moore(Mealy& machine, const std::string& type, const std::string& initial_output) {
  machine.origin["type"] = type;
  machine.origin["initial_output"] = initial_output;
}

std::optional<std::vector<std::string>> find_state_outputs(const Mealy& machine) {
  const auto initial = find_initial_output(machine);
  if (!initial) return std::nullopt;
  std::vector<std::optional<std::string>> outputs(machine.size());
  outputs[machine.initial()] = *initial;
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const std::string& name = machine.outputs().name(machine.output(state, input));
      std::optional<std::string>& output = outputs[machine.target(state, input)];
      if (output && *output != name) return std::nullopt;
      output = name;
    }
  }
  std::vector<std::string> result;
  for (const auto& output : outputs) result.push_back(output ? *output : *initial);
  return result;
}

Mealy split_states(const Mealy& machine) {
  Mealy result(machine.inputs(), machine.outputs(), 1);
  const Symbol initial = result.intern_output(find_initial_output(machine).value());
  std::vector<std::pair<StateId, Symbol>> states{{machine.initial(), initial}};  // of the result
  std::map<std::pair<StateId, Symbol>, StateId> number{{states[0], 0}};
  for (StateId state = 0; state < states.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const StateId source = states[state].first;
      const std::pair next(machine.target(source, input), machine.output(source, input));
      const auto [entry, is_new] = number.try_emplace(next, static_cast<StateId>(states.size()));
      if (is_new) {
        states.push_back(next);
        result.add_state();
      }
      result.set_transition(state, input, next.second, entry->second);
    }
  }
  result.origin = machine.origin;
  result.actors = machine.actors;
  return result;
}

}  // namespace maide
