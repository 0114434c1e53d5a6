#include "maide/wire/wrapper/reception.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/wrapper/wrapper_server.hpp"

namespace maide {
namespace {

// Options are a few hundred bytes; the rest of a client's first piece may be there, too.
constexpr std::size_t most_bytes = std::size_t{1} << 16;

void set_blocking(int descriptor, bool is_blocking) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  ::fcntl(descriptor, F_SETFL, is_blocking ? flags & ~O_NONBLOCK : flags | O_NONBLOCK);
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

Reception::Reception(int listener, const WrapperDescription& description,
                     std::optional<std::string> token, ReceptionSettings settings)
    : listener_(listener),
      token_(std::move(token)),
      settings_(settings),
      hello_(protocol::encode(hello_of(description, token_.has_value())) + '\n') {
  set_blocking(listener_, false);
}

bool Reception::has_room() const {
  return waiting_.size() < settings_.most_waiting ||
         std::any_of(waiting_.begin(), waiting_.end(),
                     [](const Waiting& client) { return !client.is_ready; });
}

int Reception::poll_limit(std::optional<std::chrono::milliseconds> limit) const {
  const auto oldest = std::find_if(waiting_.begin(), waiting_.end(),
                                   [](const Waiting& client) { return !client.is_ready; });
  if (oldest != waiting_.end()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(oldest->since + settings_.limit -
                                                                   Clock::now());
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
  if (waiting_.size() >= settings_.most_waiting) drop_most_silent();
  // It fits into the buffer of a new connection.
  if (write_some(socket.get(), hello_) != static_cast<std::ptrdiff_t>(hello_.size())) return;
  MAIDE_CHECK(waiting_.size() < settings_.most_waiting);
  Waiting& client = waiting_.emplace_back();
  client.socket = std::move(socket);
  client.since = Clock::now();
  client.is_known = !token_;
}

bool Reception::drop_most_silent() {
  const auto oldest = std::find_if(waiting_.begin(), waiting_.end(),
                                   [](const Waiting& client) { return !client.is_ready; });
  if (oldest == waiting_.end()) return false;
  tell(*oldest, protocol::ErrorCode::protocol, "too many connections wait for nothing");
  waiting_.erase(oldest);
  return true;
}

void Reception::drop_late() {
  const Clock::time_point now = Clock::now();
  waiting_.remove_if([&](const Waiting& client) {
    if (client.is_ready || now - client.since < settings_.limit) return false;
    tell(client, protocol::ErrorCode::protocol,
         fmt::format("no {} within {} s", client.is_known ? "options" : "token",
                     std::chrono::duration<double>(settings_.limit).count()));
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
    throw protocol::ProtocolError("the options are too long");
  } catch (const protocol::ProtocolError& error) {
    tell(client, protocol::ErrorCode::protocol, error.what());
    return Next::drop;
  }
}

Reception::Next Reception::take(Waiting& client, const std::string& line) const {
  if (!client.is_known) {
    std::string given;
    try {
      const auto message = protocol::decode_to_wrapper(line, {});
      if (const auto* token = std::get_if<protocol::Token>(&message)) given = token->token;
    } catch (const protocol::ProtocolError&) {
      // It is no token, whatever it is.
    }
    client.is_known = equal_in_constant_time(*token_, given);
    if (client.is_known) return Next::keep;
    tell(client, protocol::ErrorCode::token,
         given.empty() ? "a token is needed" : "the token is wrong");
    return Next::drop;
  }
  const auto message = protocol::decode_to_wrapper(line, {});
  if (std::holds_alternative<protocol::Bye>(message)) return Next::drop;
  if (std::holds_alternative<protocol::Configure>(message)) {
    client.is_ready = true;
  } else if (!std::holds_alternative<protocol::Token>(message) &&
             !std::holds_alternative<protocol::Cancel>(message)) {
    throw protocol::ProtocolError("the first line must be of type 'configure'");
  }
  return Next::keep;
}

std::optional<AcceptedClient> Reception::take_ready() {
  const auto ready = std::find_if(waiting_.begin(), waiting_.end(),
                                  [](const Waiting& client) { return client.is_ready; });
  if (ready == waiting_.end()) return std::nullopt;
  MAIDE_CHECK(ready->is_known);  // nobody is served without the token
  set_blocking(ready->socket.get(), true);
  AcceptedClient client{std::move(ready->socket), std::move(ready->received)};
  waiting_.erase(ready);
  return client;
}

// As much as the connection takes: nobody is waited for.
void Reception::tell(const Waiting& client, protocol::ErrorCode code, const std::string& message) {
  write_some(client.socket.get(),
             protocol::encode(protocol::ErrorReport{code, one_line(message), {}}) + '\n');
}

}  // namespace maide
