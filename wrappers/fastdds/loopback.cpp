#include "loopback.hpp"

#include <arpa/inet.h>
#include <fastrtps/utils/IPLocator.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace maide::fastdds {

namespace rtps = eprosima::fastrtps::rtps;

std::uint16_t free_udp_port() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  const bool bound = socket >= 0 && ::bind(socket, generic, length) == 0 &&
                     ::getsockname(socket, generic, &length) == 0;
  const int error = errno;
  if (socket >= 0) ::close(socket);
  if (!bound) throw std::system_error(error, std::generic_category(), "a UDP port of 127.0.0.1");
  return ::ntohs(address.sin_port);
}

rtps::Locator_t loopback_locator(std::uint16_t port) {
  rtps::Locator_t locator;
  rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, loopback, port, locator);
  return locator;
}

}  // namespace maide::fastdds
