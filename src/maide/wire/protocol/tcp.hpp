// TCP connections: HOST:PORT as a person types it, listening, connecting; and the token that a
// client of a listening wrapper names.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "maide/base/file.hpp"

namespace maide::tcp {

struct Address {
  std::string host;  // a name or a number; an IPv6 number is typed in brackets
  std::string port;
};

// "HOST:PORT" or "[IPV6]:PORT". Throws UsageError.
Address parse_address(const std::string& text);

struct Listener {
  Descriptor socket;
  std::string name;  // "127.0.0.1:40123", the port being the real one
  bool is_loopback = false;
};
// Throws UsageError if the address cannot be listened on.
Listener listen(const Address& address);

// A connected socket that does not block. `should_stop` is asked a few times a second. Throws
// std::runtime_error "connection refused", "no connection within 10 s", ...
Descriptor connect(const Address& address, std::chrono::milliseconds limit,
                   const std::function<bool()>& should_stop);

// Small answers at once, and a peer that vanishes without a word is noticed in the end.
void set_up(int socket);

}  // namespace maide::tcp

// ---- The token ----
//
// The secret that a client names to a wrapper that listens. Both sides read it the same way, and
// never from the command line, which others can see.

namespace maide {

// The first line of `file`; without a file the variable MAIDE_TOKEN; nothing if that is not set or
// empty. Throws UsageError if the file cannot be read or begins with an empty line.
std::optional<std::string> read_token(const std::optional<std::string>& file);

}  // namespace maide
