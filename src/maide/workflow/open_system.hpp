// From what a person types to a system that can be asked: simulates a model, starts wrappers'
// processes, or connects to ones that listen. Several are asked at once, as a pool.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/wrapper_options.hpp"
#include "maide/workflow/system_spec.hpp"

namespace maide {

// More systems at once than this are a mistake.
inline constexpr std::size_t most_jobs = 256;

struct SystemAccess {
  std::string token_file;  // of a listening wrapper; empty: MAIDE_TOKEN, if it is set
  // The translation asked for; a simulated plain Mealy machine is only taken for an interface
  // automaton (outputs joined by ',', "quiet" for none) if one is.
  std::optional<Translation> translation;
  std::size_t jobs = 0;  // systems that are asked at once; 0: default_jobs()
};

// A wrapper of ours: one for each processor. A program: one, since nobody knows whether a second
// one can run beside it. Hosts: one connection to each. A simulation: one, for it never waits.
std::size_t default_jobs(const SystemSpec& spec);

struct OpenedSystem {
  std::unique_ptr<Sul> sul;
  std::optional<Mealy> reference;  // the machine to be learned, where the system is a simulation
  std::size_t jobs = 1;            // how many there are
};

// Throws UsageError for a system or an option that does not exist, for too many jobs or fewer than
// hosts, and for systems that are not the same; WrapperError if one cannot be reached or says
// nothing sensible within 10 s. Later, those that fail are given up with a warning in the log.
OpenedSystem open_system(const SystemSpec& spec, const SystemAccess& access = {},
                         const RunControl& control = {});

// The options of the system; a simulated model has none. Options given in `spec` are not looked at.
// Throws as open_system does.
std::vector<OptionSpec> list_system_options(const SystemSpec& spec, const SystemAccess& access = {},
                                            const RunControl& control = {});

}  // namespace maide
