// Where the names of YARP's ports are kept: in the process itself (YARP's local mode), or by a
// yarpserver, one of the wrapper's own or one that is given.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "maide/wire/client/child_process.hpp"

namespace maide::yarp_ports {

class NameServer {
 public:
  // `where`: "none", "own" or "HOST:PORT". Sets YARP up in this process. Throws UsageError for
  // another text, std::runtime_error if there is no server, or it cannot be started.
  explicit NameServer(const std::string& where);

  // The server's process, if it is the wrapper's own: one of its threads wakes ten times a second,
  // and does nothing.
  std::optional<pid_t> process() const;

 private:
  std::uint16_t start_own();  // its TCP port

  std::unique_ptr<ServiceProcess> own_;
};

}  // namespace maide::yarp_ports
