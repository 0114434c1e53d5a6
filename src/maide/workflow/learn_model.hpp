// From a system to its model: a learning run through the IA translator, the minimal Mealy machine
// of it, and the interface automaton that the machine stands for. What `maide learn`, `maide
// reproduce` and system files with learned instances share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/formats/labelled_graph.hpp"
#include "maide/sul/ia_translator.hpp"
#include "maide/workflow/experiment.hpp"
#include "maide/workflow/system_ends.hpp"

namespace maide {

struct LearnedModel {
  // The interface automaton (nondeterministic ones are learned with nstar); the Mealy machine where
  // the system is a plain one, or where a run that
  // ended early left no machine that an automaton stands for; nothing if it ended before the first
  // hypothesis.
  std::optional<Model> model;
  Translation translation = Translation::eager;
  bool is_plain = false;         // the system is a plain Mealy machine: no translation
  std::size_t mealy_states = 0;  // of the minimal machine of the translation
  std::vector<SystemEnd> ends;   // crashes and hangs of `model`, an interface automaton
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
                         const RunControl& control = {});

}  // namespace maide
