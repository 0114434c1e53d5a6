#include "maide/check/language/shared_steps.hpp"

#include <algorithm>

#include "maide/base/invariant.hpp"

namespace maide {

ModelUse SharedActions::action(std::uint32_t model, const std::string& name,
                               const std::function<std::vector<std::vector<ModelStep>>()>& steps) {
  auto& actions = system_.models[model].actions;
  const auto [place, is_new] = known_[model].try_emplace(name, static_cast<Symbol>(actions.size()));
  if (is_new) actions.push_back({name, steps()});
  return {ModelUse::Kind::act, model, place->second};
}

ModelUse SharedActions::action(std::uint32_t model, const std::string& name, StepsOfState steps) {
  ModelInstance& instance = system_.models[model];
  const std::size_t known = instance.actions.size();
  const ModelUse use = action(model, name, [&] {
    std::vector<std::vector<ModelStep>> made;
    for (StateId state = 0; state < instance.automaton.size(); ++state) {
      made.push_back(steps(state));
    }
    return made;
  });
  if (instance.is_grown && instance.actions.size() > known) {
    growing_[model].push_back(std::move(steps));
    MAIDE_CHECK(growing_[model].size() == instance.actions.size());
  }
  return use;
}

void SharedActions::make_steps(std::uint32_t model, StateId state) {
  ModelInstance& instance = system_.models[model];
  for (std::size_t action = 0; action < instance.actions.size(); ++action) {
    auto& steps = instance.actions[action].steps;
    if (steps.size() < instance.automaton.size()) steps.resize(instance.automaton.size());
    steps[state] = growing_.at(model)[action](state);
  }
}

ModelUse SharedActions::variable(std::uint32_t model, const std::vector<bool>* values,
                                 std::optional<Value> value) {
  const ModelInstance& variable = this->model(model);
  const ValueType& type = variable.type;
  std::string name;
  if (values != nullptr) {
    for (std::uint64_t place = 0; place < type.count(); ++place) {
      if (!(*values)[place]) continue;
      name += (name.empty() ? "" : ", ") + to_string(type.at(place), type.kind, words());
    }
    const bool is_one = std::count(values->begin(), values->end(), true) == 1;
    name = variable.name + (is_one ? " == " + name : " in {" + name + "}");
  }
  if (value) {
    name +=
        (name.empty() ? "" : ", ") + variable.name + " = " + to_string(*value, type.kind, words());
  }
  return action(model, name, [&] {
    std::vector<std::vector<ModelStep>> steps(type.count());
    for (std::uint64_t place = 0; place < type.count(); ++place) {
      if (values != nullptr && !(*values)[place]) continue;
      const std::uint64_t target = value ? type.place_of(*value) : place;
      steps[place] = {{static_cast<StateId>(target), false}};
    }
    return steps;
  });
}

std::vector<ModelUse> SharedActions::variables(const Conditions& conditions,
                                               const SharedValues& writes) {
  std::vector<ModelUse> uses;
  for (const auto& [model, values] : conditions) {
    const auto write = writes.find(model);
    uses.push_back(variable(model, &values,
                            write == writes.end() ? std::nullopt : std::optional(write->second)));
  }
  for (const auto& [model, value] : writes) {
    if (!conditions.contains(model)) uses.push_back(variable(model, nullptr, value));
  }
  std::sort(uses.begin(), uses.end(),
            [](const ModelUse& a, const ModelUse& b) { return a.model < b.model; });
  return uses;
}

bool is_of_same_actor(const InterfaceAutomaton& automaton, Symbol input, Symbol output) {
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const std::string& in = automaton.inputs().name(input);
  const std::string& out = automaton.outputs().name(output);
  bool is_known = false;
  for (const Actor& actor : automaton.actors) {
    if (!has(actor.inputs, in)) continue;
    is_known = true;
    if (has(actor.outputs, out)) return true;
  }
  return !is_known;
}

namespace {

// The outputs of the input's actor that are due in the state.
std::vector<InterfaceAutomaton::Transition> due(const InterfaceAutomaton& automaton, StateId state,
                                                Symbol input) {
  std::vector<InterfaceAutomaton::Transition> result;
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action.is_input()) continue;
    if (is_of_same_actor(automaton, input, transition.action.symbol)) result.push_back(transition);
  }
  return result;
}

}  // namespace

std::optional<ModelUse> SharedActions::input_and_output(std::uint32_t model, Symbol input,
                                                        std::optional<Symbol> output) {
  const InterfaceAutomaton& automaton = this->model(model).automaton;
  const std::string name =
      automaton.inputs().name(input) +
      (output ? " -> " + automaton.outputs().name(*output) : std::string(", without an output"));
  // Two ways to the same state are one step.
  const auto add = [](std::vector<ModelStep>& to, StateId target) {
    const ModelStep step{target, false};
    if (std::find(to.begin(), to.end(), step) == to.end()) to.push_back(step);
  };
  const bool is_grown = this->model(model).is_grown;
  if (is_grown && output && !is_of_same_actor(automaton, input, *output)) return std::nullopt;
  const ModelUse use = action(model, name, [&automaton, input, output, add](StateId state) {
    std::vector<ModelStep> steps;
    if (!automaton.is_quiescent(state)) return steps;
    for (const auto& given : automaton.transitions(state)) {
      if (!given.action.is_input() || given.action.symbol != input || given.absorbed) continue;
      const auto follows = due(automaton, given.target, input);
      if (!output && follows.empty()) add(steps, given.target);
      for (const auto& taken : follows) {
        if (output && taken.action.symbol == *output) add(steps, taken.target);
      }
    }
    return steps;
  });
  if (!is_possible(use)) return std::nullopt;
  return use;
}

std::optional<ModelUse> SharedActions::beyond(std::uint32_t model, Symbol input) {
  const InterfaceAutomaton& automaton = this->model(model).automaton;
  const auto is_beyond = [&automaton, input](StateId state) {
    return automaton.is_quiescent(state) && is_beyond_learned(automaton, state, input);
  };
  const ModelUse use = action(
      model, automaton.inputs().name(input) + ", never tried there", [is_beyond](StateId state) {
        return is_beyond(state) ? std::vector<ModelStep>{{state, true}} : std::vector<ModelStep>{};
      });
  if (!is_possible_now(use)) return std::nullopt;
  return use;
}

std::optional<ModelUse> SharedActions::idle(std::uint32_t model,
                                            const std::vector<ModelUse>& uses) {
  const ModelInstance& instance = this->model(model);
  std::string name;
  for (const ModelUse& use : uses) {
    using Kind = ModelUse::Kind;
    name += name.empty() ? "" : "; ";
    if (use.kind == Kind::act) name += instance.actions[use.symbol].name;
    if (use.kind == Kind::give) name += instance.automaton.inputs().name(use.symbol);
    if (use.kind == Kind::take) name += "!" + instance.automaton.outputs().name(use.symbol);
  }
  const ModelUse idle = action(model, "none of: " + name, [&instance, uses](StateId state) {
    const bool can = std::any_of(uses.begin(), uses.end(), [&](const ModelUse& use) {
      return !model_steps(instance, state, use).empty();
    });
    const bool is_idle = !can && instance.automaton.is_quiescent(state);
    return is_idle ? std::vector<ModelStep>{{state, false}} : std::vector<ModelStep>{};
  });
  if (!is_possible(idle)) return std::nullopt;
  return idle;
}

ModelUse SharedActions::impossible(std::uint32_t model, const std::vector<ModelUse>& uses) {
  const ModelInstance& instance = this->model(model);
  std::string name = "cannot:";
  for (const ModelUse& use : uses) {
    using Kind = ModelUse::Kind;
    if (use.kind == Kind::act) name += " " + instance.actions[use.symbol].name + ";";
    if (use.kind == Kind::give) name += " " + instance.automaton.inputs().name(use.symbol) + ";";
    if (use.kind == Kind::take) name += " !" + instance.automaton.outputs().name(use.symbol) + ";";
  }
  return action(model, name, [&instance, uses](StateId state) {
    const bool can = std::any_of(uses.begin(), uses.end(), [&](const ModelUse& use) {
      return !model_steps(instance, state, use).empty();
    });
    return can ? std::vector<ModelStep>{} : std::vector<ModelStep>{{state, false}};
  });
}

std::optional<ModelUse> SharedActions::both(const ModelUse& use, const ModelUse& condition) {
  const ModelInstance& instance = model(use.model);
  const auto name_of = [&](const ModelUse& of) -> std::string {
    switch (of.kind) {
      case ModelUse::Kind::act: return instance.actions[of.symbol].name;
      case ModelUse::Kind::give: return instance.automaton.inputs().name(of.symbol);
      case ModelUse::Kind::take: return "!" + instance.automaton.outputs().name(of.symbol);
      default: return "nothing due";
    }
  };
  const ModelUse both =
      action(use.model, name_of(use) + ", and " + name_of(condition),
             [&instance, use, condition](StateId state) {
               const bool holds = !model_steps(instance, state, condition).empty();
               return holds ? model_steps(instance, state, use) : std::vector<ModelStep>{};
             });
  if (!is_possible(both)) return std::nullopt;
  return both;
}

bool SharedActions::is_possible(const ModelUse& action) {
  return model(action.model).is_grown || is_possible_now(action);
}

bool SharedActions::is_possible_now(const ModelUse& action) {
  const auto [place, is_new] = possible_.try_emplace(action);
  if (is_new) {
    const auto& steps = model(action.model).actions[action.symbol].steps;
    place->second =
        std::any_of(steps.begin(), steps.end(), [](const auto& at) { return !at.empty(); });
  }
  return place->second;
}

bool SharedActions::are_possible(const std::vector<ModelUse>& uses) {
  return std::all_of(uses.begin(), uses.end(), [&](const ModelUse& use) {
    return use.kind != ModelUse::Kind::act || is_possible(use);
  });
}

}  // namespace maide
