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
#include <utility>
#include <variant>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"

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

// Of one end of a connection: `get` is getsockname or getpeername.
std::string name_of(int socket, int (*get)(int, sockaddr*, socklen_t*)) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  get(socket, reinterpret_cast<sockaddr*>(&address), &size);
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
  // By itself the kernel would begin to ask after two hours.
  const int idle = 20, between = 10, most_asked = 3;  // seconds, seconds, times
  ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &idle, sizeof idle);
  ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &between, sizeof between);
  ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &most_asked, sizeof most_asked);
  const unsigned unanswered_ms = 50'000;  // what was sent and is not acknowledged
  ::setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &unanswered_ms, sizeof unanswered_ms);
}

void set_blocking(int socket, bool is_blocking) {
  const int flags = ::fcntl(socket, F_GETFL);
  ::fcntl(socket, F_SETFL, is_blocking ? flags & ~O_NONBLOCK : flags | O_NONBLOCK);
}

std::string peer_name(int socket) { return name_of(socket, ::getpeername); }

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
    listener.name = name_of(listener.socket.get(), ::getsockname);
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

namespace {

// Options are a few hundred bytes, a hello some thousands; the rest of the first piece may be
// there, too.
constexpr std::size_t most_bytes = std::size_t{1} << 16;

// The token that the line names; nothing if it is no such line, whatever it is.
std::optional<std::string> token_in(const std::string& line) {
  try {
    auto message = protocol::decode_to_wrapper(line, {});
    if (auto* token = std::get_if<protocol::Token>(&message)) return std::move(token->token);
  } catch (const protocol::ProtocolError&) {
    // It may be of the other direction.
  }
  return std::nullopt;
}

// Of accept4: the connection was gone again, or a signal came.
bool is_passing(int error) {
  return error == EINTR || error == ECONNABORTED || error == EPROTO || error == EPERM ||
         error == ETIMEDOUT;
}

bool is_shortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

}  // namespace

bool equal_in_constant_time(std::string_view left, std::string_view right) {
  std::size_t difference = left.size() ^ right.size();
  for (std::size_t i = 0; i < left.size(); ++i) {
    const char other = right.empty() ? '\0' : right[i % right.size()];
    difference |= static_cast<std::size_t>(static_cast<unsigned char>(left[i] ^ other));
  }
  return difference == 0;
}

tcp::Listener listen_guarded(const std::string& host_port,
                             const std::optional<std::string>& token) {
  tcp::Listener listener = tcp::listen(tcp::parse_address(host_port));
  if (!listener.is_loopback && !token) {
    throw UsageError("listening on " + listener.name +
                     ", which is not loopback, needs a token (--token-file or MAIDE_TOKEN)");
  }
  return listener;
}

Reception::Reception(int listener, ReceptionRules rules)
    : listener_(listener), rules_(std::move(rules)) {
  if (!rules_.greeting.empty()) rules_.greeting += '\n';
  tcp::set_blocking(listener_, false);
}

bool Reception::has_room() const {
  return waiting_.size() < rules_.most_waiting ||
         std::ranges::any_of(waiting_, [](const Waiting& client) { return !client.is_ready; });
}

int Reception::poll_limit(std::optional<std::chrono::milliseconds> limit) const {
  const auto oldest =
      std::ranges::find_if(waiting_, [](const Waiting& client) { return !client.is_ready; });
  if (oldest != waiting_.end()) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(oldest->since + rules_.limit - Clock::now());
    limit = std::max(std::chrono::milliseconds(0), std::min(left, limit.value_or(left)));
  }
  return limit ? static_cast<int>(limit->count()) : -1;
}

void Reception::wait(std::optional<std::chrono::milliseconds> limit) {
  std::vector<pollfd> sockets{{has_room() ? listener_ : -1, POLLIN, 0}};
  for (const Waiting& client : waiting_) {
    sockets.push_back({client.is_ready ? -1 : client.socket.get(), POLLIN, 0});
  }
  if (::poll(sockets.data(), sockets.size(), poll_limit(limit)) > 0) {
    auto socket = sockets.begin();
    for (auto client = waiting_.begin(); client != waiting_.end();) {
      const bool is_over = (++socket)->revents != 0 && read(*client) == Next::drop;
      client = is_over ? waiting_.erase(client) : std::next(client);
    }
    if (sockets.front().revents != 0) accept_all();
  }
  drop_late();
}

void Reception::accept_all() {
  while (has_room()) {
    Descriptor socket(::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const int error = errno;
    if (socket.is_open()) {
      admit(std::move(socket));
    } else if (error == EAGAIN || error == EWOULDBLOCK) {
      return;
    } else if (is_shortage(error)) {
      if (drop_most_silent()) continue;
      constexpr int pause_ms = 50;  // clients that are served will go
      ::poll(nullptr, 0, pause_ms);
      return;
    } else if (!is_passing(error)) {
      throw UsageError("cannot accept clients any more: " + std::generic_category().message(error));
    }
  }
}

void Reception::admit(Descriptor socket) {
  if (waiting_.size() >= rules_.most_waiting) drop_most_silent();
  // It fits into the buffer of a new connection.
  const auto greeted = static_cast<std::ptrdiff_t>(rules_.greeting.size());
  if (greeted > 0 && write_some(socket.get(), rules_.greeting) != greeted) return;
  MAIDE_CHECK(waiting_.size() < rules_.most_waiting);
  Waiting& client = waiting_.emplace_back();
  client.socket = std::move(socket);
  client.since = Clock::now();
  client.is_known = !rules_.token;
}

bool Reception::drop_most_silent() {
  const auto oldest =
      std::ranges::find_if(waiting_, [](const Waiting& client) { return !client.is_ready; });
  if (oldest == waiting_.end()) return false;
  tell(*oldest, protocol::ErrorCode::protocol, "too many connections wait for nothing");
  waiting_.erase(oldest);
  return true;
}

void Reception::drop_late() {
  const Clock::time_point now = Clock::now();
  waiting_.remove_if([&](const Waiting& client) {
    if (client.is_ready || now - client.since < rules_.limit) return false;
    tell(client, protocol::ErrorCode::protocol,
         fmt::format("no {} within {} s", client.is_known ? rules_.awaited : "token",
                     std::chrono::duration<double>(rules_.limit).count()));
    return true;
  });
}

Reception::Next Reception::read(Waiting& client) const {
  std::string bytes;
  switch (read_some(client.socket.get(), bytes)) {
    case ReadResult::nothing_yet: return Next::keep;
    case ReadResult::ended: return Next::drop;
    case ReadResult::some: break;
  }
  client.received += bytes;
  try {
    client.lines.append(bytes);
    while (!client.is_ready) {
      const std::optional<std::string> line = client.lines.take_line();
      if (!line) break;
      if (take(client, *line) == Next::drop) return Next::drop;
    }
    if (client.is_ready || client.received.size() <= most_bytes) return Next::keep;
    throw protocol::ProtocolError("too much comes before the " + rules_.awaited);
  } catch (const protocol::ProtocolError& error) {
    tell(client, protocol::ErrorCode::protocol, error.what());
    return Next::drop;
  }
}

Reception::Next Reception::take(Waiting& client, const std::string& line) const {
  const std::optional<std::string> token = token_in(line);
  if (token) client.received.erase(0, client.received.find('\n') + 1);
  if (!client.is_known) {
    const std::string given = token.value_or("");
    client.is_known = equal_in_constant_time(*rules_.token, given);
    if (client.is_known) return Next::keep;
    const std::string why = given.empty() ? "a token is needed" : "the token is wrong";
    tell(client, protocol::ErrorCode::token, why);
    if (rules_.on_refusal) rules_.on_refusal(tcp::peer_name(client.socket.get()), why);
    return Next::drop;
  }
  if (token) return Next::keep;  // one more than is needed
  switch (rules_.judge(line)) {
    case ReceptionRules::Verdict::ready: client.is_ready = true; return Next::keep;
    case ReceptionRules::Verdict::drop: return Next::drop;
    case ReceptionRules::Verdict::wait: break;
  }
  return Next::keep;
}

std::optional<AcceptedClient> Reception::take_ready() {
  const auto ready = std::ranges::find_if(waiting_, &Waiting::is_ready);
  if (ready == waiting_.end()) return std::nullopt;
  MAIDE_CHECK(ready->is_known);  // nobody is served without the token
  AcceptedClient client{std::move(ready->socket), std::move(ready->received), ""};
  client.peer = tcp::peer_name(client.socket.get());
  waiting_.erase(ready);
  return client;
}

// As much as the connection takes: nobody is waited for.
void Reception::tell(const Waiting& client, protocol::ErrorCode code, const std::string& message) {
  write_some(client.socket.get(),
             protocol::encode(protocol::ErrorReport{code, one_line(message), {}}) + '\n');
}

}  // namespace maide
