#include "maide/workflow/learn_model.hpp"

#include <exception>
#include <string>
#include <utility>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/named_table.hpp"
#include "maide/learn/learners.hpp"
#include "maide/learn/sul_oracle.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/workflow/nondeterministic_run.hpp"

namespace maide {
namespace {

// What the machine stands for. A hypothesis of an unfinished run may stand for nothing yet; that of
// a finished one shows a wrapper that breaks the rules, which is `error` then.
Model to_model(const Mealy& machine, const IaTranslator& translator, std::exception_ptr& error) {
  if (!translator.info().has_actors) return machine;
  try {
    InterfaceAutomaton automaton = translator.to_interface_automaton(machine);
    automaton.origin["translation"] = to_string(translator.translation());
    return automaton;
  } catch (const UsageError& failure) {
    if (!error) {
      error = std::make_exception_ptr(WrapperError(failure.what(), translator.info().name));
    }
    return machine;
  }
}

}  // namespace

std::size_t LearnedModel::states() const {
  if (!model) return 0;
  return std::visit([](const auto& learned) { return learned.size(); }, *model);
}

std::size_t LearnedModel::transitions() const {
  if (!model) return 0;
  if (const auto* machine = std::get_if<Mealy>(&*model)) {
    return machine->size() * machine->inputs().size();
  }
  if (const auto* machine = std::get_if<NondeterministicMealy>(&*model)) {
    return machine->transition_count();
  }
  return std::get<InterfaceAutomaton>(*model).transition_count();
}

namespace {

// The automaton that the machine stands for, or the machine where there is none; see to_model.
Model to_model(const NondeterministicMealy& machine, const IaTranslator& translator,
               std::exception_ptr& error) {
  if (!translator.info().has_actors) {
    if (!machine.is_complete()) return machine;
    if (auto deterministic = machine.to_mealy()) return std::move(*deterministic);
    return machine;
  }
  try {
    InterfaceAutomaton automaton = translator.to_interface_automaton(machine);
    automaton.origin["translation"] = to_string(translator.translation());
    return automaton;
  } catch (const UsageError& failure) {
    if (!error) {
      error = std::make_exception_ptr(WrapperError(failure.what(), translator.info().name));
    }
    return machine;
  }
}

// A refused input, and one that is not offered, was not tried there.
std::vector<std::string> find_inputs_without_effect(const Mealy& machine, Translation translation) {
  std::vector<std::string> names;
  for (Symbol input = 0; input < machine.inputs().size(); ++input) {
    const std::string& name = machine.inputs().name(input);
    if (translation == Translation::av && name == delta_input) continue;
    bool is_tried = false, has_effect = false;
    for (StateId state = 0; state < machine.size(); ++state) {
      const std::string& output = machine.outputs().name(machine.output(state, input));
      is_tried =
          is_tried || (output != "refused" && output != "unexplored" && output != "absorbed");
      has_effect = has_effect || machine.target(state, input) != state;
    }
    if (is_tried && !has_effect) names.push_back(name);
  }
  return names;
}

LearnedModel learn_nondeterministic(IaTranslator& translator, LearnedModel learned,
                                    const ExperimentOptions& options, const RunControl& control) {
  if (translator.translation() != Translation::eager) {
    throw UsageError("nstar learns the eager translation");
  }
  if (options.traces != nullptr) throw UsageError("nstar cannot start from traces");
  if (options.old_model || !options.known_models.empty()) {
    throw UsageError("nstar cannot start from an old model");
  }
  SulOracle system(translator);
  NondeterministicResult result = run_nondeterministic_experiment(system, options, control);
  learned.experiment = std::move(result.experiment);
  if (result.model.size() == 0) return learned;
  result.model.origin.emplace("sul", translator.info().name);
  if (!learned.experiment.is_complete()) result.model.origin["incomplete"] = "the run ended early";
  learned.mealy_states = result.model.size();
  learned.model = to_model(result.model, translator, learned.experiment.error);
  return learned;
}

}  // namespace

LearnedModel learn_model(Sul& sul, Translation translation, const ExperimentOptions& options,
                         const RunControl& control) {
  IaTranslator translator(sul, translation);
  LearnedModel learned;
  learned.translation = translation;
  learned.is_plain = !sul.info().has_actors;
  if (options.algorithm == nstar_name) {
    learned = learn_nondeterministic(translator, std::move(learned), options, control);
    learned.incidents = sul.incidents();
    return learned;
  }
  if (!options.algorithm.empty()) {
    find_row(learners(), "algorithm", options.algorithm, {nstar_name});  // it takes nstar, too
  }
  learned.experiment = run_experiment(translator, options, control);
  learned.incidents = sul.incidents();
  Mealy& machine = learned.experiment.model;
  if (machine.size() == 0) return learned;
  machine = minimize(machine);
  machine.origin.emplace("sul", sul.info().name);
  if (!learned.experiment.is_complete()) machine.origin["incomplete"] = "the run ended early";
  learned.mealy_states = machine.size();
  learned.inputs_without_effect = find_inputs_without_effect(machine, translation);
  learned.model = to_model(machine, translator, learned.experiment.error);
  if (auto* automaton = std::get_if<InterfaceAutomaton>(&*learned.model)) {
    learned.ends = find_system_ends(*automaton, translator);
    if (!learned.ends.empty()) automaton->origin["ends"] = to_string(learned.ends);
  }
  return learned;
}

}  // namespace maide
