#include "maide/check/system/model_actions.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {

ModelUse ModelActions::action(std::uint32_t model, const std::string& name,
                              const std::function<Steps()>& steps) {
  auto& actions = system_.models[model].actions;
  const auto [place, is_new] = known_[model].try_emplace(name, static_cast<Symbol>(actions.size()));
  if (is_new) {
    const auto made = made_[model].find(name);
    actions.push_back({name, made == made_[model].end() ? steps() : std::move(made->second)});
  }
  return {ModelUse::Kind::act, model, place->second};
}

ModelUse ModelActions::action(std::uint32_t model, const std::string& name, StepsOfState steps) {
  ModelInstance& instance = system_.models[model];
  const bool grows = instance.is_grown && may_grow_;
  const std::size_t known = instance.actions.size();
  const ModelUse use = action(model, name, [&] {
    Steps made;
    if (grows) return made;  // a step may come to a new state
    for (StateId state = 0; state < instance.automaton.size(); ++state) {
      made.push_back(steps(state));
    }
    return made;
  });
  if (grows && instance.actions.size() > known) {
    growing_[model].push_back(std::move(steps));
    MAIDE_CHECK(growing_[model].size() == instance.actions.size());
  }
  return use;
}

void ModelActions::make_steps(std::uint32_t model, StateId state) {
  ModelInstance& instance = system_.models[model];
  for (std::size_t action = 0; action < instance.actions.size(); ++action) {
    auto& steps = instance.actions[action].steps;
    if (steps.size() < instance.automaton.size()) steps.resize(instance.automaton.size());
    steps[state] = growing_.at(model)[action](state);
  }
}

void ModelActions::renumber(std::uint32_t model, const std::vector<StateId>& numbers,
                            const std::vector<bool>& reached) {
  ModelInstance& instance = system_.models[model];
  const std::size_t states = instance.automaton.size();
  std::vector<bool> is_made(states);
  for (StateId state = 0; state < numbers.size(); ++state) {
    if (reached[state]) is_made[numbers[state]] = true;
  }
  // In their order: a condition reads the steps of actions before it.
  for (std::size_t action = 0; action < instance.actions.size(); ++action) {
    Steps& steps = instance.actions[action].steps;
    const Steps before = std::exchange(steps, Steps(states));
    for (StateId state = 0; state < before.size(); ++state) {
      if (!reached[state]) continue;
      for (ModelStep step : before[state]) {
        step.target = numbers[step.target];
        steps[numbers[state]].push_back(step);
      }
    }
    for (StateId state = 0; state < states; ++state) {
      if (!is_made[state]) steps[state] = growing_.at(model)[action](state);
    }
  }
}

ModelActions::Made ModelActions::take_all() {
  Made all(system_.models.size());
  for (std::size_t model = 0; model < all.size(); ++model) {
    for (ModelAction& action : system_.models[model].actions) {
      all[model].emplace(std::move(action.name), std::move(action.steps));
    }
    system_.models[model].actions.clear();
  }
  return all;
}

ModelUse ModelActions::variable(std::uint32_t model, const std::vector<bool>* values,
                                std::optional<Value> value) {
  const ModelInstance& variable = this->model(model);
  const ValueType& type = variable.type;
  std::string name;
  if (values != nullptr) {
    for (std::uint64_t place = 0; place < type.count(); ++place) {
      if (!(*values)[place]) continue;
      name += (name.empty() ? "" : ", ") + to_string(type.at(place), type.kind, words());
    }
    const bool is_one = std::ranges::count(*values, true) == 1;
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

std::vector<ModelUse> ModelActions::variables(const Conditions& conditions,
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
  std::ranges::sort(uses, {}, &ModelUse::model);
  return uses;
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

std::optional<ModelUse> ModelActions::input_and_output(std::uint32_t model, Symbol input,
                                                       std::optional<Symbol> output) {
  const InterfaceAutomaton& automaton = this->model(model).automaton;
  const std::string name =
      automaton.inputs().name(input) +
      (output ? " -> " + automaton.outputs().name(*output) : std::string(", without an output"));
  // Two ways to the same state are one step.
  const auto add = [](std::vector<ModelStep>& to, StateId target) {
    const ModelStep step{target, false};
    if (std::ranges::find(to, step) == to.end()) to.push_back(step);
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

std::optional<ModelUse> ModelActions::beyond(std::uint32_t model, Symbol input) {
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

namespace {

std::string name_of(const ModelInstance& model, const ModelUse& use) {
  switch (use.kind) {
    case ModelUse::Kind::act: return model.actions[use.index].name;
    case ModelUse::Kind::give: return model.automaton.inputs().name(use.index);
    case ModelUse::Kind::take: return "!" + model.automaton.outputs().name(use.index);
    default: return "nothing due";
  }
}

std::string names_of(const ModelInstance& model, const std::vector<ModelUse>& uses) {
  std::string names;
  for (const ModelUse& use : uses) names += (names.empty() ? "" : "; ") + name_of(model, use);
  return names;
}

bool takes_any(const ModelInstance& model, StateId state, const std::vector<ModelUse>& uses) {
  return std::ranges::any_of(
      uses, [&](const ModelUse& use) { return !model_steps(model, state, use).empty(); });
}

// The step of a condition.
std::vector<ModelStep> stays_if(bool holds, StateId state) {
  return holds ? std::vector<ModelStep>{{state, false}} : std::vector<ModelStep>{};
}

}  // namespace

std::optional<ModelUse> ModelActions::idle(std::uint32_t model, const std::vector<ModelUse>& uses) {
  const ModelInstance& instance = this->model(model);
  const ModelUse idle =
      action(model, "none of: " + names_of(instance, uses), [&instance, uses](StateId state) {
        const bool is_idle =
            instance.automaton.is_quiescent(state) && !takes_any(instance, state, uses);
        return stays_if(is_idle, state);
      });
  if (!is_possible(idle)) return std::nullopt;
  return idle;
}

ModelUse ModelActions::impossible(std::uint32_t model, const std::vector<ModelUse>& uses) {
  const ModelInstance& instance = this->model(model);
  return action(model, "cannot: " + names_of(instance, uses), [&instance, uses](StateId state) {
    return stays_if(!takes_any(instance, state, uses), state);
  });
}

std::optional<ModelUse> ModelActions::both(const ModelUse& use, const ModelUse& condition) {
  const ModelInstance& instance = model(use.model);
  const ModelUse both =
      action(use.model, name_of(instance, use) + ", and " + name_of(instance, condition),
             [&instance, use, condition](StateId state) {
               return takes_any(instance, state, {condition}) ? model_steps(instance, state, use)
                                                              : std::vector<ModelStep>{};
             });
  if (!is_possible(both)) return std::nullopt;
  return both;
}

bool ModelActions::is_possible(const ModelUse& action) {
  return model(action.model).is_grown || is_possible_now(action);
}

bool ModelActions::is_possible_now(const ModelUse& action) {
  const auto [place, is_new] = possible_.try_emplace(action);
  if (is_new) {
    const auto& steps = model(action.model).actions[action.index].steps;
    place->second = std::ranges::any_of(steps, [](const auto& at) { return !at.empty(); });
  }
  return place->second;
}

std::vector<Uses> ModelActions::combine(const std::vector<Uses>& some,
                                        const std::vector<Uses>& others) {
  std::vector<Uses> result;
  for (const Uses& one : some) {
    for (const Uses& other : others) {
      Uses together = one;
      bool is_possible = true;
      for (const ModelUse& use : other) {
        const auto same =
            std::find_if(together.begin(), together.end(),
                         [&](const ModelUse& known) { return known.model == use.model; });
        if (same == together.end()) {
          together.push_back(use);
        } else if (const auto joined = both(*same, use)) {
          *same = *joined;
        } else {
          is_possible = false;
        }
      }
      if (is_possible) result.push_back(std::move(together));
    }
  }
  return result;
}

bool ModelActions::are_possible(const std::vector<ModelUse>& uses) {
  return std::ranges::all_of(uses, [&](const ModelUse& use) {
    return use.kind != ModelUse::Kind::act || is_possible(use);
  });
}

}  // namespace maide
