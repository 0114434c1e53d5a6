#include "maide/wire/protocol/tcp.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/numbers.hpp"

namespace maide::tcp {
namespace {

using AddressList = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

// Throws std::runtime_error.
AddressList resolve(const Address& address, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int error = ::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list);
  if (error != 0) throw std::runtime_error(::gai_strerror(error));
  return {list, &::freeaddrinfo};
}

std::string error_text(int error) { return std::generic_category().message(error); }

bool is_loopback(const sockaddr* address) {
  if (address->sa_family == AF_INET) {
    const auto* ip = reinterpret_cast<const sockaddr_in*>(address);
    return (ntohl(ip->sin_addr.s_addr) >> 24) == 127;
  }
  const auto* ip = reinterpret_cast<const sockaddr_in6*>(address);
  return address->sa_family == AF_INET6 && IN6_IS_ADDR_LOOPBACK(&ip->sin6_addr);
}

std::string name_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  ::getnameinfo(reinterpret_cast<sockaddr*>(&address), size, host.data(), host.size(), port.data(),
                port.size(), NI_NUMERICHOST | NI_NUMERICSERV);
  const bool is_ipv6 = address.ss_family == AF_INET6;
  return fmt::format("{}{}{}:{}", is_ipv6 ? "[" : "", host.data(), is_ipv6 ? "]" : "", port.data());
}

Descriptor open_socket(const addrinfo& address, int flags) {
  return Descriptor(
      ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | flags, address.ai_protocol));
}

// Waits for a connection that is being made; 0, or an error.
int finish_connecting(int socket, std::chrono::steady_clock::time_point deadline,
                      const std::function<bool()>& should_stop) {
  constexpr int piece_ms = 50;
  while (true) {
    pollfd waiting{socket, POLLOUT, 0};
    const int ready = ::poll(&waiting, 1, piece_ms);
    if (ready > 0) {
      int error = 0;
      socklen_t size = sizeof error;
      ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
      return error;
    }
    if (should_stop()) return ECANCELED;
    if (std::chrono::steady_clock::now() >= deadline) return ETIMEDOUT;
  }
}

}  // namespace

Address parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  Address address;
  if (colon != std::string::npos) {
    address = {text.substr(0, colon), text.substr(colon + 1)};
    const bool is_bracketed = address.host.starts_with('[') && address.host.ends_with(']');
    if (is_bracketed) address.host = address.host.substr(1, address.host.size() - 2);
    if (!is_bracketed && address.host.find(':') != std::string::npos) address.host.clear();
  }
  if (address.host.empty() || !parse_number<std::uint16_t>(address.port)) {
    throw UsageError(fmt::format("'{}' is not HOST:PORT", text));
  }
  return address;
}

void set_up(int socket) {
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
}

Listener listen(const Address& address) {
  const std::string where = address.host + ":" + address.port;
  try {
    const AddressList list = resolve(address, AI_PASSIVE);
    Listener listener;
    listener.socket = open_socket(*list, 0);
    listener.is_loopback = is_loopback(list->ai_addr);
    const int on = 1;
    ::setsockopt(listener.socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (::bind(listener.socket.get(), list->ai_addr, list->ai_addrlen) != 0 ||
        ::listen(listener.socket.get(), SOMAXCONN) != 0) {
      throw std::runtime_error(error_text(errno));
    }
    listener.name = name_of(listener.socket.get());
    return listener;
  } catch (const std::runtime_error& error) {
    throw UsageError(fmt::format("cannot listen on {}: {}", where, error.what()));
  }
}

Descriptor connect(const Address& address, std::chrono::milliseconds limit,
                   const std::function<bool()>& should_stop) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  const AddressList list = resolve(address, 0);
  int error = ECONNREFUSED;
  for (const addrinfo* entry = list.get(); entry != nullptr; entry = entry->ai_next) {
    Descriptor socket = open_socket(*entry, SOCK_NONBLOCK);
    error = ::connect(socket.get(), entry->ai_addr, entry->ai_addrlen) == 0 ? 0 : errno;
    if (error == EINPROGRESS || error == EINTR) {
      error = finish_connecting(socket.get(), deadline, should_stop);
    }
    if (error == 0) {
      set_up(socket.get());
      return socket;
    }
  }
  throw std::runtime_error(error == ETIMEDOUT
                               ? fmt::format("no connection within {} s", limit.count() / 1000)
                               : error_text(error));
}

}  // namespace maide::tcp

namespace maide {

std::optional<std::string> read_token(const std::optional<std::string>& file) {
  if (!file) {
    const char* variable = std::getenv("MAIDE_TOKEN");
    if (variable == nullptr || *variable == '\0') return std::nullopt;
    return variable;
  }
  std::string token = read_file(*file);
  token.erase(std::min(token.find_first_of("\r\n"), token.size()));
  if (token.empty()) throw UsageError("there is no token in the file (" + *file + ")");
  return token;
}

}  // namespace maide
