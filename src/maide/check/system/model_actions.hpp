// What a step does with models beyond one input or one output: conditions on shared variables and
// assignments to them, an input with the output that follows at once, a model at rest. Each becomes
// an action of its model (ModelAction), which is made once.
//
// What depends on shared variables is found by trying: it is evaluated, asks for a variable, and is
// evaluated again for each value that this may have. Values that come to the same go together.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/language/system_names.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

using Uses = std::vector<ModelUse>;  // in one step; of different models

// Sets of the values of shared variables, by model and place in the type.
using Conditions = std::map<std::uint32_t, std::vector<bool>>;
using SharedValues = std::map<std::uint32_t, Value>;

template <typename Result>
struct Outcome {
  Conditions conditions;
  Result result;
  bool operator==(const Outcome&) const = default;
};

// Thrown by what asks for a shared variable whose value is not given.
struct SharedDemand {
  std::uint32_t model = 0;
};

// At most this many outcomes of one expression, `atomic` or row of guards.
inline constexpr std::size_t max_outcomes = 10'000;

class ModelActions {
 public:
  using Steps = std::vector<std::vector<ModelStep>>;  // of an action, by state
  // By model: the actions that are known already, by their names.
  using Made = std::vector<std::map<std::string, Steps>>;

  // Keeps a reference: its models' actions grow. Models that grow may do so.
  explicit ModelActions(System& system)
      : system_(system), known_(system.models.size()), made_(known_.size()) {}
  // No model grows any more.
  ModelActions(System& system, Made made)
      : system_(system), known_(made.size()), made_(std::move(made)), may_grow_(false) {}

  const ModelInstance& model(std::uint32_t index) const { return system_.models[index]; }
  InterfaceAutomaton& automaton(std::uint32_t index) { return system_.models[index].automaton; }
  const WordTable& words() const { return system_.words; }
  WordTable& words() { return system_.words; }

  // The action with that name, which says all of it; `steps` makes it.
  ModelUse action(std::uint32_t model, const std::string& name,
                  const std::function<Steps()>& steps);
  // An action that is made state by state; if the model may grow, by make_steps() alone.
  using StepsOfState = std::function<std::vector<ModelStep>(StateId)>;
  ModelUse action(std::uint32_t model, const std::string& name, StepsOfState steps);
  // Makes the steps in that state of all actions of a model that grows.
  void make_steps(std::uint32_t model, StateId state);
  // The model grows no more, and its states have other numbers, or were cut off. Makes the steps in
  // those of its states that were not reached.
  void renumber(std::uint32_t model, const std::vector<StateId>& numbers,
                const std::vector<bool>& reached);
  // All actions that were made, which the system has no more.
  Made take_all();
  // The variable has one of the values (null: any), and afterwards `value` (none: the same).
  ModelUse variable(std::uint32_t model, const std::vector<bool>* values,
                    std::optional<Value> value);
  // All conditions and assignments, in the order of the models.
  std::vector<ModelUse> variables(const Conditions& conditions, const SharedValues& writes);

  // Gives the input and takes the output of the same actor that is due at once (none: there is
  // none). None if that is possible nowhere; here and below, a model that grows may come to where
  // it is.
  std::optional<ModelUse> input_and_output(std::uint32_t model, Symbol input,
                                           std::optional<Symbol> output);
  // Gives the input where it was never tried. None if there is no such place.
  std::optional<ModelUse> beyond(std::uint32_t model, Symbol input);
  // The model has no output due, and cannot take any of these uses. None if it always can.
  std::optional<ModelUse> idle(std::uint32_t model, const std::vector<ModelUse>& uses);
  // The condition that the model cannot take any of these uses.
  ModelUse impossible(std::uint32_t model, const std::vector<ModelUse>& uses);
  // The use where the condition holds, on the same model. None if that is nowhere.
  std::optional<ModelUse> both(const ModelUse& use, const ModelUse& condition);
  // Both, each of some ways, where that is possible.
  std::vector<Uses> combine(const std::vector<Uses>& some, const std::vector<Uses>& others);
  // Whether each model can be used so in some state; of actions, which are looked at once.
  bool are_possible(const std::vector<ModelUse>& uses);

 private:
  bool is_possible(const ModelUse& action);
  bool is_possible_now(const ModelUse& action);

  System& system_;
  std::vector<std::map<std::string, Symbol>> known_;  // by model
  Made made_;
  bool may_grow_ = true;
  std::map<ModelUse, bool> possible_;                           // actions
  std::map<std::uint32_t, std::vector<StepsOfState>> growing_;  // by model, by action
};

// Runs `evaluate` for every combination of shared values that it asks for. Throws ParseError (at
// `where`) beyond max_outcomes.
template <typename Result>
std::vector<Outcome<Result>> outcomes_of(const std::function<Result(const SharedValues&)>& evaluate,
                                         const ModelActions& actions, const SourcePosition& where,
                                         SharedValues& known) {
  std::uint32_t asked = 0;
  try {
    return {{{}, evaluate(known)}};
  } catch (const SharedDemand& demand) {
    asked = demand.model;
  }
  const ValueType& type = actions.model(asked).type;
  std::vector<std::pair<std::vector<bool>, std::vector<Outcome<Result>>>> groups;
  std::size_t count = 0;
  for (std::uint64_t place = 0; place < type.count(); ++place) {
    known[asked] = type.at(place);
    auto met = outcomes_of(evaluate, actions, where, known);
    auto group = groups.begin();
    while (group != groups.end() && group->second != met) ++group;
    if (group == groups.end()) {
      count += met.size();
      if (count > max_outcomes) {
        throw ParseError("this depends on shared variables in more than " +
                             std::to_string(max_outcomes) + " ways",
                         where);
      }
      groups.emplace_back(std::vector<bool>(type.count(), false), std::move(met));
      group = groups.end() - 1;
    }
    group->first[place] = true;
  }
  known.erase(asked);
  if (groups.size() == 1) return std::move(groups.front().second);
  std::vector<Outcome<Result>> result;
  for (auto& [values, outcomes] : groups) {
    for (auto& outcome : outcomes) {
      outcome.conditions.emplace(asked, values);
      result.push_back(std::move(outcome));
    }
  }
  return result;
}

}  // namespace maide
