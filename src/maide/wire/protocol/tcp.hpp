// TCP connections: HOST:PORT as a person types it, listening, connecting; the token that whoever
// connects names; and where connections wait until they are worth more.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <string_view>

#include "maide/base/file.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/protocol.hpp"

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

// Small answers at once, and a peer that vanishes without a word is noticed within a minute.
void set_up(int socket);
void set_blocking(int socket, bool is_blocking);

// Who is at the other end: "NUMBER:PORT".
std::string peer_name(int socket);

}  // namespace maide::tcp

// ---- The token ----
//
// The secret that whoever connects names to whoever listens: a client to a wrapper, or a wrapper
// that dials in to Maide. Both sides read it the same way, and never from the command line, which
// others can see.

namespace maide {

// The first line of `file`; without a file the variable MAIDE_TOKEN; nothing if that is not set or
// empty. Throws UsageError if the file cannot be read or begins with an empty line.
std::optional<std::string> read_token(const std::optional<std::string>& file);

// Equal, in a time that depends on the lengths only.
bool equal_in_constant_time(std::string_view left, std::string_view right);

// Listens, and throws UsageError if an address that is not loopback would be open to everybody.
tcp::Listener listen_guarded(const std::string& host_port, const std::optional<std::string>& token);

// ---- Reception ----
//
// Where connections wait until they are worth a process or a system. The token and the first line
// must come within ten seconds. One thread does all of it, with a descriptor for each connection
// that waits, 256 at most. A newcomer takes the place of the connection that has been silent
// longest, so a crowd of silent connections keeps nobody out that speaks.

struct ReceptionRules {
  std::string greeting;              // a line that every connection is told first; "": none
  std::optional<std::string> token;  // that it must name
  std::string awaited;               // what must come then: "options", for messages
  // Of a line behind the token. ready: it is what was awaited. Throws ProtocolError.
  enum class Verdict : std::uint8_t { wait, ready, drop };
  std::function<Verdict(const std::string& line)> judge;
  // Hears of each connection that is refused for its token; may be empty.
  std::function<void(const std::string& peer, const std::string& why)> on_refusal = {};
  std::size_t most_waiting = 256;           // connections that are not ready
  std::chrono::milliseconds limit{10'000};  // for the token and what is awaited
};

// A connection that has named the token, if one is needed, and said what was awaited.
struct AcceptedClient {
  Descriptor socket;     // does not block
  std::string received;  // all that it sent behind the token
  std::string peer;      // its peer_name()
};

class Reception {
 public:
  // `listener`, a listening socket, stays the caller's, but does not block any more.
  Reception(int listener, ReceptionRules rules);

  // Waits until something happens, at most so long, or for ever without a limit. Takes new
  // connections, reads, and drops connections that are late, wrong or too many. Throws UsageError
  // if the listener takes no connections any more. O(connections).
  void wait(std::optional<std::chrono::milliseconds> limit);
  // The connection that has waited longest of those that are ready, if there is one.
  std::optional<AcceptedClient> take_ready();
  // Closes all connections: in the process of one client the others are not its own.
  void clear() { waiting_.clear(); }

  std::size_t size() const { return waiting_.size(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    Descriptor socket;
    Clock::time_point since;
    LineSplitter lines;
    std::string received;
    bool is_known = false;  // has named the token, or needs none
    bool is_ready = false;
  };
  enum class Next : std::uint8_t { keep, drop };

  int poll_limit(std::optional<std::chrono::milliseconds> limit) const;
  bool has_room() const;
  void accept_all();
  void admit(Descriptor socket);
  bool drop_most_silent();
  void drop_late();
  Next read(Waiting& client) const;
  Next take(Waiting& client, const std::string& line) const;
  static void tell(const Waiting& client, protocol::ErrorCode code, const std::string& message);

  int listener_;
  ReceptionRules rules_;
  std::list<Waiting> waiting_;  // the oldest first
};

}  // namespace maide
