// From what a person types to a system that can be asked: simulates a model, starts a wrapper's
// process, or connects to one that listens.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/sul/sul.hpp"
#include "maide/workflow/system_spec.hpp"

namespace maide {

struct SystemAccess {
  std::string token_file;  // of a listening wrapper; empty: MAIDE_TOKEN, if it is set
  // The translation asked for; a simulated plain Mealy machine is only taken for an interface
  // automaton (outputs joined by ',', "quiet" for none) if one is.
  std::optional<Translation> translation;
};

struct OpenedSystem {
  std::unique_ptr<Sul> sul;
  std::optional<Mealy> reference;  // the machine to be learned, where the system is a simulation
};

// Throws UsageError for a system or an option that does not exist, WrapperError if the system
// cannot be reached or says nothing sensible within 10 s.
OpenedSystem open_system(const SystemSpec& spec, const SystemAccess& access = {},
                         const RunControl& control = {});

// The options of the system, a line each, with defaults, allowed values and help. Options given in
// `spec` are not looked at. Throws as open_system does.
std::string list_system_options(const SystemSpec& spec, const SystemAccess& access = {},
                                const RunControl& control = {});

}  // namespace maide
