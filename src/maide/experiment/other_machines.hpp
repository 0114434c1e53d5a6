// Wrappers on other machines: a command starts them on the hosts of a file (`--launch`, `--hosts`),
// or they dial in (`--accept`). Those that are launched must all be the same, so the run begins
// when each host has answered or failed. Of those that dial in the first decides what the system
// is, and later ones take part as soon as they come.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/client/wrapper_connection.hpp"

namespace maide {

// Throws UsageError for parts of `access` that do not go together, or not with the system.
void check_machines(const SystemSpec& spec, const SystemAccess& access);

// ---- Launched ----

// A line of a file of hosts: a name, and how many wrappers run there.
struct Host {
  std::string name;
  std::size_t wrappers = 1;
};

// "NAME [COUNT]" a line; '#' begins a comment. Throws UsageError for a file that cannot be read or
// names nobody, a host that is there twice, a count that is none, and more than most_jobs wrappers.
std::vector<Host> read_hosts(const std::string& path);

// The command for one host: split as a shell would, and run without one. {host} is replaced
// everywhere. A word that is {wrapper} alone becomes the program and its arguments, a word each; in
// a longer word they are quoted for a shell. Throws UsageError if {host} is missing.
std::vector<std::string> launch_command(const std::string& launch, const std::string& host,
                                        const std::vector<std::string>& wrapper);

// One for each wrapper on each host. Throws as the two do.
std::vector<WrapperEndpoint> launched_endpoints(const SystemAccess& access,
                                                const std::vector<std::string>& wrapper);

// ---- Dialling in ----

// Listens at `access.accept`, says so, and waits for the first wrapper; later ones join in.
// `wrapper` is the program, for the hint. Throws UsageError (the address, the options),
// Interrupted, and Error (system_failed) if none comes in time.
std::unique_ptr<Sul> await_wrappers(const SystemSpec& spec, const SystemAccess& access,
                                    const std::string& wrapper, const RunControl& control);

}  // namespace maide
