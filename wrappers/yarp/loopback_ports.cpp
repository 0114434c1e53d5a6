#include "loopback_ports.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "maide/base/file.hpp"

namespace maide::yarp_ports {
namespace {

// YARP listens on all addresses, so the port must be free on all of them.
std::uint16_t free_port() {
  const Descriptor probe(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (!probe.is_open() || ::bind(probe.get(), generic, size) != 0 ||
      ::getsockname(probe.get(), generic, &size) != 0) {
    throw std::runtime_error("no TCP port is free: " + std::generic_category().message(errno));
  }
  return ntohs(address.sin_port);
}

}  // namespace

std::uint16_t LoopbackPorts::take() {
  {
    const std::scoped_lock lock(mutex_);
    if (!free_.empty()) {
      const std::uint16_t port = free_.back();
      free_.pop_back();
      return port;
    }
  }
  return free_port();
}

void LoopbackPorts::give_back(std::uint16_t port) {
  const std::scoped_lock lock(mutex_);
  free_.push_back(port);
}

}  // namespace maide::yarp_ports
