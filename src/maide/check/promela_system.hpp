// A whole system as Promela, for SPIN (Holzmann, "The SPIN Model Checker", 2003): one proctype for
// each automaton; a model meets the programs on two rendezvous channels, its InChannel and its
// OutChannel, as in the paper. One transition of the Promela is one step of the system: every
// transition is a single rendezvous or expression followed by gotos, which cost nothing, so it is
// atomic without further ado. (Only where a rendezvous is received could `atomic` stand: a sender
// inside `atomic` takes its goto as a step of its own.) So the states of the text with
// Purpose::deadlock, explored without reduction, are those of the system and one more: the state
// before the processes are started.
//
// `quiet` is an output that a quiescent model offers again and again. What lies beyond the bound is
// a message of its own, `beyond_write`, with what it does chosen by the purpose.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/check/system.hpp"

namespace maide {

struct PromelaOptions {
  enum class Purpose : std::uint8_t {
    deadlock,  // invalid end states are the system's deadlocks; a cut is a self-loop, so the states
               // are those of the system before any cut
    cut,       // an assertion fails where a run leaves what was learned
    ltl,       // a never claim for the property; a cut makes the rest of the run satisfy everything
  };
  Purpose purpose = Purpose::deadlock;
  Formula formula;  // of Purpose::ltl; without X
};

// Which transition stands in a line of the text.
struct PromelaLine {
  enum class Kind : std::uint8_t { none, program_edge, model_transition };
  Kind kind = Kind::none;
  std::uint32_t owner = 0;   // program or model instance
  std::uint32_t index = 0;   // edge of the program
  StateId model_target = 0;  // of the model's transition
  bool is_beyond = false;    // the step goes beyond what was learned
};

struct PromelaSystem {
  std::string text;                // without the never claim
  std::vector<PromelaLine> lines;  // by line of the text, from 1; [0] is not used
  std::string claim;               // Purpose::ltl: the negated formula for `spin -f`
  std::size_t processes = 0;
};

// Throws UsageError if the system has more symbols or processes than SPIN can have (250).
PromelaSystem write_promela(const System& system, const PromelaOptions& options = {});

}  // namespace maide
