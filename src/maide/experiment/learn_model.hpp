// From a system to its model, in three steps: a learning run through the IA translator, its minimal
// Mealy machine, and the interface automaton that the machine stands for. `maide learn`, `maide
// reproduce` and system files with learned instances share it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/run_control.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/labelled_graph.hpp"
#include "maide/sul/ia_translator.hpp"

namespace maide {

// Where a learned system crashes or hangs: each end with a shortest word that causes it, for
// whoever has to mend it.
struct SystemEnd {
  std::string output;             // "crash" or "hang"
  std::vector<std::string> word;  // the shortest inputs that lead there; the last one does it
  std::size_t states = 0;         // in so many states of the model that input does it
  std::string reason;             // in the wrapper's words; "" if only a cache knows of it
};

// One for each kind of end and input that causes it, shortest words first. The reason is that of
// the word itself where the system was asked it, else that of another with the same last input.
// O(transitions + words).
std::vector<SystemEnd> find_system_ends(const InterfaceAutomaton& automaton,
                                        const IaTranslator& translator);

// "crash: write close (the wrapper was killed by signal 6 (Aborted))"
std::string to_string(const SystemEnd& end);
// The same of all, joined by "; ".
std::string to_string(std::span<const SystemEnd> ends);

// What a learned model is.
enum class ModelKind : std::uint8_t {
  automaton,  // an interface automaton; of a plain Mealy machine itself
  machine,    // the Mealy machine of the translation
  by_system,  // a machine where the system names no actors, else an automaton
};

// "ia" and "mealy", as users type them; "" is by_system. Throws UsageError for anything else.
ModelKind read_model_kind(std::string_view name);

struct LearnedModel {
  // As the ModelKind says (nstar learns nondeterministic ones). A Mealy machine, too, if a run that
  // ended early left a machine that no automaton stands for. Nothing if the run ended before the
  // first hypothesis.
  std::optional<Model> model;
  Translation translation = Translation::eager;
  bool is_plain = false;         // the system is a plain Mealy machine: no translation
  std::size_t mealy_states = 0;  // of the minimal machine of the translation
  std::vector<SystemEnd> ends;   // crashes and hangs of the interface automaton
  // Inputs that were tried and change no state of the deterministic machine, in their order.
  std::vector<std::string> inputs_without_effect;
  SulIncidents incidents;  // of the system's processes in this run, which were put right
  ExperimentResult experiment;

  std::size_t states() const;       // of `model`; 0 without one
  std::size_t transitions() const;  // of `model`: a Mealy machine has states x inputs
};

// Learns the system behind `sul`. The model's origin names the system, its options and versions,
// the bound, algorithm, tests, seed, and the words that end the system ("ends"). Throws as
// run_experiment does; what ends a run early is in `experiment.error`.
LearnedModel learn_model(Sul& sul, Translation translation, const ExperimentOptions& options,
                         const RunControl& control = {}, ModelKind kind = ModelKind::automaton);

}  // namespace maide
