#include "maide/workflow/learn_model.hpp"

#include <exception>
#include <utility>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"

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
  return std::get<InterfaceAutomaton>(*model).transition_count();
}

LearnedModel learn_model(Sul& sul, Translation translation, const ExperimentOptions& options,
                         const RunControl& control) {
  IaTranslator translator(sul, translation);
  LearnedModel learned;
  learned.translation = translation;
  learned.is_plain = !sul.info().has_actors;
  learned.experiment = run_experiment(translator, options, control);
  Mealy& machine = learned.experiment.model;
  if (machine.size() == 0) return learned;
  machine = minimize(machine);
  machine.origin.emplace("sul", sul.info().name);
  if (!learned.experiment.is_complete()) machine.origin["incomplete"] = "the run ended early";
  learned.mealy_states = machine.size();
  learned.model = to_model(machine, translator, learned.experiment.error);
  return learned;
}

}  // namespace maide
