// A whole system as Promela, for SPIN (Holzmann, "The SPIN Model Checker", 2003). Each program is a
// proctype, whose labels are its control states. There are two forms.
//
// A system of plain rendezvous has its models as processes, which meet the programs on channels, as
// in the paper. A system with more than that - shared variables, steps with several models, arms of
// `select`, deaths, errors, programs at rest - has the state of each model in a variable, and makes
// each step one `d_step` (promela_steps.cpp).
//
// Invariant: one transition of the Promela is one step of the system. So the states of the text,
// explored without reduction, are those of the system, but for what PromelaSystem names.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/engines/export/step_rules.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct PromelaOptions {
  enum class Purpose : std::uint8_t {
    deadlock,  // invalid end states are the system's deadlocks; a cut is a self-loop, so the states
               // are those of the system before any cut
    error,     // an assertion fails at an error; else as `deadlock`, but for what end states are
    cut,       // an assertion fails where a run leaves what was learned
    ltl,       // a never claim for the property; a cut makes the rest of the run satisfy everything
  };
  Purpose purpose = Purpose::deadlock;
  Formula formula;  // of Purpose::ltl; without X
  // Trails of pan are read, in which each step is to be one line. Without, a text with more steps
  // than SPIN's d_steps can have has them in `atomic`s.
  bool has_trails = false;
};

// Which transition stands in a line of the text.
struct PromelaLine {
  enum class Kind : std::uint8_t { none, program_edge, model_transition, step };
  Kind kind = Kind::none;
  std::uint32_t owner = 0;   // program or model instance
  std::uint32_t index = 0;   // edge of the program; of a step: into PromelaSystem::steps
  StateId model_target = 0;  // of the model's transition
  bool is_beyond = false;    // the step goes beyond what was learned
};

struct PromelaSystem {
  // A step in one line: StepRules::step_of() of these.
  struct Step {
    StepRule rule;
    std::vector<std::uint32_t> ranks;
  };

  std::string text;                // without the never claim
  std::vector<PromelaLine> lines;  // by line of the text, from 1; [0] is not used
  std::string claim;               // Purpose::ltl: the negated formula for `spin -f`
  std::size_t processes = 0;
  std::shared_ptr<const StepRules> rules;  // of the form with steps, which it is written from
  std::vector<Step> steps;
  // The processes are started by a step of their own: there is one state more, before it.
  bool has_start = false;
  // Purposes deadlock and ltl: each state is there twice, before and after nobody dies any more.
  bool is_doubled = false;
};

// Throws UsageError if the system has more symbols, processes or states of a model than SPIN can
// have, or the formula compares too many values.
PromelaSystem write_promela(const System& system, const PromelaOptions& options = {});

}  // namespace maide
