#include "maide/experiment/learn_model.hpp"

#include <algorithm>
#include <deque>
#include <exception>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/experiment/nondeterministic_run.hpp"
#include "maide/formats/names.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"
#include "maide/sul/fatal_words.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

// The shortest words of inputs to the states, breadth first; outputs on the way count for nothing.
std::vector<std::optional<std::vector<std::string>>> access_words(
    const InterfaceAutomaton& automaton) {
  std::vector<std::optional<std::vector<std::string>>> words(automaton.size());
  std::deque<std::pair<StateId, std::vector<std::string>>> work;
  work.emplace_back(automaton.initial(), std::vector<std::string>());
  while (!work.empty()) {
    const auto [state, word] = std::move(work.front());
    work.pop_front();
    if (words[state]) continue;
    words[state] = word;
    for (const auto& transition : automaton.transitions(state)) {
      if (!transition.action.is_input()) {
        work.emplace_front(transition.target, word);
        continue;
      }
      work.emplace_back(transition.target, word);
      work.back().second.push_back(automaton.inputs().name(transition.action.symbol));
    }
  }
  return words;
}

// The output by which the system ends in `state`, or "".
std::string end_due(const InterfaceAutomaton& automaton, StateId state) {
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action.is_input()) continue;
    const std::string& output = automaton.outputs().name(transition.action.symbol);
    if (is_end_output(output)) return output;
  }
  return "";
}

std::string reason_of(const SystemEnd& end, const IaTranslator& translator) {
  const FatalWord* best = nullptr;
  for (const FatalWord& known : translator.fatal_words()) {
    if ((known.end == WordEnd::hang) != (end.output == "hang") || known.reason.empty()) continue;
    std::vector<std::string> word;
    for (const Symbol input : known.inputs) {
      if (input < translator.info().inputs.size()) {
        word.push_back(translator.info().inputs[input].name);
      }
    }
    if (word == end.word) return known.reason;
    const bool is_alike = word.back() == end.word.back();
    if (is_alike && (best == nullptr || known.inputs.size() < best->inputs.size())) best = &known;
  }
  return best == nullptr ? "" : best->reason;
}

}  // namespace

std::vector<SystemEnd> find_system_ends(const InterfaceAutomaton& automaton,
                                        const IaTranslator& translator) {
  std::vector<SystemEnd> ends;
  const auto words = access_words(automaton);
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (!transition.action.is_input() || !words[state]) continue;
      const std::string output = end_due(automaton, transition.target);
      if (output.empty()) continue;
      std::vector<std::string> word = *words[state];
      word.push_back(automaton.inputs().name(transition.action.symbol));
      const auto known = std::ranges::find_if(ends, [&](const SystemEnd& end) {
        return end.output == output && end.word.back() == word.back();
      });
      if (known == ends.end()) {
        ends.push_back({output, std::move(word), 1, ""});
        continue;
      }
      ++known->states;
      if (std::pair(word.size(), word) < std::pair(known->word.size(), known->word)) {
        known->word = std::move(word);
      }
    }
  }
  std::ranges::sort(ends, [](const SystemEnd& left, const SystemEnd& right) {
    return std::tuple(left.word.size(), left.word, left.output) <
           std::tuple(right.word.size(), right.word, right.output);
  });
  for (SystemEnd& end : ends) end.reason = reason_of(end, translator);
  return ends;
}

std::string to_string(const SystemEnd& end) {
  std::string text = end.output + ": " + join(end.word, " ");
  if (!end.reason.empty()) text += " (" + end.reason + ")";
  return text;
}

std::string to_string(std::span<const SystemEnd> ends) {
  std::string text;
  for (const SystemEnd& end : ends) text += (text.empty() ? "" : "; ") + to_string(end);
  return text;
}

namespace {

// What the machine stands for; nothing for a plain system. A hypothesis of an unfinished run may
// stand for nothing yet; that of a finished one shows a wrapper that breaks the rules, which is
// `error` then.
template <typename Machine>
std::optional<InterfaceAutomaton> to_automaton(const Machine& machine,
                                               const IaTranslator& translator,
                                               std::exception_ptr& error) {
  if (!translator.info().has_actors) return std::nullopt;
  try {
    InterfaceAutomaton automaton = translator.to_interface_automaton(machine);
    automaton.origin["translation"] = to_string(translator.translation());
    return automaton;
  } catch (const UsageError& failure) {
    if (!error) {
      error = std::make_exception_ptr(WrapperError(failure.what(), translator.info().name));
    }
    return std::nullopt;
  }
}

// The machine as a model of its own. What the automaton that it stands for says of the system, it
// says, too.
template <typename Machine>
Machine as_model(Machine machine, const std::optional<InterfaceAutomaton>& automaton,
                 const IaTranslator& translator) {
  if (!automaton) return machine;
  for (const auto& [key, value] : automaton->origin) machine.origin[key] = value;
  if (translator.info().names_actors) machine.actors = automaton->actors;
  if (!automaton->hidden_returns.empty()) {
    machine.origin["hidden_returns"] = join_names(automaton->hidden_returns);
  }
  return machine;
}

bool is_machine_wanted(ModelKind kind, const SulInfo& system) {
  return kind == ModelKind::machine || (kind == ModelKind::by_system && !system.names_actors);
}

}  // namespace

ModelKind read_model_kind(std::string_view name) {
  if (name.empty()) return ModelKind::by_system;
  if (name == "ia") return ModelKind::automaton;
  if (name == "mealy") return ModelKind::machine;
  throw UsageError("unknown kind of model '" + std::string(name) + "'; known are: mealy, ia");
}

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

// Of a plain system: deterministic, if it turned out to be.
Model plain_model(const NondeterministicMealy& machine) {
  if (!machine.is_complete()) return machine;
  if (auto deterministic = machine.to_mealy()) return std::move(*deterministic);
  return machine;
}

LearnedModel learn_nondeterministic(IaTranslator& translator, LearnedModel learned,
                                    const ExperimentOptions& options, const RunControl& control,
                                    bool is_machine) {
  if (translator.translation() != Translation::eager) {
    throw UsageError("nstar learns the eager translation");
  }
  if (options.traces != nullptr) throw UsageError("nstar cannot start from traces");
  if (!options.error_outputs.empty())
    throw UsageError("nstar knows no outputs that end the session");
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
  auto automaton = to_automaton(result.model, translator, learned.experiment.error);
  if (automaton && !is_machine) {
    learned.model = *std::move(automaton);
  } else {
    learned.model = plain_model(as_model(std::move(result.model), automaton, translator));
  }
  return learned;
}

}  // namespace

LearnedModel learn_model(Sul& sul, Translation translation, const ExperimentOptions& options,
                         const RunControl& control, ModelKind kind) {
  IaTranslator translator(sul, translation);
  const bool is_machine = is_machine_wanted(kind, sul.info());
  LearnedModel learned;
  learned.translation = translation;
  learned.is_plain = !sul.info().has_actors;
  if (find_learner(options.algorithm).is_nondeterministic()) {
    learned = learn_nondeterministic(translator, std::move(learned), options, control, is_machine);
    learned.incidents = sul.incidents();
    return learned;
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
  auto automaton = to_automaton(machine, translator, learned.experiment.error);
  if (automaton) {
    learned.ends = find_system_ends(*automaton, translator);
    if (!learned.ends.empty()) automaton->origin["ends"] = to_string(learned.ends);
  }
  if (automaton && !is_machine) {
    learned.model = *std::move(automaton);
  } else {
    learned.model = as_model(machine, automaton, translator);
  }
  return learned;
}

}  // namespace maide
