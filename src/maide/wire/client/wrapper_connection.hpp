// One live connection to a wrapper: where the wrapper is (`WrapperEndpoint`), wrappers that dial in
// (`DialIns`), lines out and lines in (`WrapperConnection`), and what its deaths prove
// (`DeathRecord`).
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/tcp.hpp"

namespace maide {

// Where wrappers dial in, in a thread of its own. A wrapper whose process has ended dials again
// before the old connection ends, and says so. Its connection is kept a second for the system that
// is about to lose the old one; a system takes any, for all are of the same system. What nobody
// waits for is one more.
class DialIns {
 public:
  // Told of connections that are refused for their token, a few times at most.
  using Warn = std::function<void(std::string_view message)>;

  // Throws UsageError if the address cannot be listened on, and without a token unless it is
  // loopback.
  DialIns(const std::string& host_port, std::optional<std::string> token, Warn warn = {});
  ~DialIns();
  DialIns(const DialIns&) = delete;
  DialIns& operator=(const DialIns&) = delete;

  const std::string& address() const { return listener_.name; }  // with the real port

  // The next connection, if it comes within the limit, for a system that has lost its own.
  std::optional<AcceptedClient> take_replacement(std::chrono::milliseconds limit,
                                                 const std::function<bool()>& should_stop);
  // A connection that no system waits for; nothing once a stop is requested. Throws UsageError if
  // nothing can come any more.
  std::optional<AcceptedClient> take_newcomer(const std::stop_token& stop);

 private:
  struct Ready {
    AcceptedClient client;
    bool dials_again;
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  };
  void receive(const std::stop_token& stop);
  std::deque<Ready>::iterator find_newcomer();

  tcp::Listener listener_;
  Reception reception_;  // the thread's
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Ready> ready_;
  std::size_t waiting_ = 0;  // systems that wait for a replacement
  std::exception_ptr error_;
  std::jthread thread_;
};

// A wrapper that is to be started, one that listens, or one that has dialled in.
class WrapperEndpoint {
 public:
  // `argv[0]` is found on PATH unless it has a '/'. `name` is for messages; "" makes one of argv.
  static WrapperEndpoint program(std::vector<std::string> argv, std::string name = "");
  // Throws UsageError if it is not HOST:PORT. `token` is "" if there is none.
  static WrapperEndpoint tcp(const std::string& host_port, std::string token = "");
  // `first` is used first, then whatever dials in.
  static WrapperEndpoint dialled(std::shared_ptr<DialIns> dial_ins, AcceptedClient first);

  const std::string& name() const { return name_; }
  bool is_program() const { return !argv_.empty(); }
  bool has_dialled() const { return dial_ins_ != nullptr; }
  const std::vector<std::string>& argv() const { return argv_; }
  const std::string& host_port() const { return host_port_; }
  const std::string& token() const { return token_; }
  // Of wrappers that dial in: the next connection. Throws std::runtime_error if there is none.
  AcceptedClient take_connection(const std::function<bool()>& should_stop) const;

 private:
  std::vector<std::string> argv_;
  std::string host_port_, token_, name_;
  std::shared_ptr<DialIns> dial_ins_;
  std::shared_ptr<std::optional<AcceptedClient>> first_;  // nothing in it: it was used
};

// The wrapper is gone. what(): "exited with status 3: its last words", "closed the connection".
class ConnectionLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class WrapperConnection {
 public:
  // Starts the wrapper, connects to it, or takes a connection that it made. `should_stop` is asked
  // a few times a second. Throws WrapperError if that fails.
  WrapperConnection(const WrapperEndpoint& endpoint, std::chrono::milliseconds limit,
                    const std::function<bool()>& should_stop);
  // Ends the wrapper: bye, a short grace, kill.
  ~WrapperConnection();
  WrapperConnection(const WrapperConnection&) = delete;
  WrapperConnection& operator=(const WrapperConnection&) = delete;

  // Queues a line (without its newline); it goes out with the next receive().
  void send(std::string_view line);
  // The next line, if one comes within `limit`. Throws ConnectionLost, or ProtocolError for a line
  // that is too long or cut.
  std::optional<std::string> receive(std::chrono::milliseconds limit);
  // No grace for this one: it hangs.
  void kill();

 private:
  int read_descriptor() const { return child_ ? child_->output.get() : socket_.get(); }
  int write_descriptor() const { return child_ ? child_->input.get() : socket_.get(); }
  void transfer(std::chrono::milliseconds limit);
  void flush();
  [[noreturn]] void throw_lost();

  std::unique_ptr<ChildProcess> child_;
  Descriptor socket_;
  LineSplitter lines_;
  std::string outgoing_;
  bool ended_ = false;       // nothing more will be read
  bool child_gone_ = false;  // the wrapper's process has ended
};

// ---- Deaths ----
//
// What is known of a word in which the wrapper died: where each time, and what that means. A death
// alone proves nothing, for anybody may kill a process. Deaths at the same step behind the same
// answers, alone in a fresh process, are the system's own doing, and an observation.

// One death of the wrapper while it had a word to answer.
struct Death {
  WordEnd end = WordEnd::crash;  // hang: it did not come to rest, or gave no sign of life
  std::string reason;            // in words
  // The steps that were over, where that is known.
  std::optional<std::vector<SulStep>> before;
  bool in_reset = false;  // it had not even begun
};

class DeathRecord {
 public:
  enum class Verdict : std::uint8_t {
    ask_again,
    reproducible,  // last() is what the word does
    hopeless,      // it dies again and again, at differing places
  };
  // A crash is reproducible at the third death, of which two are known to be at the same place: the
  // first may be anybody's. A hang, which nobody does from outside and which costs a step limit
  // each time, at the second at the same place.
  Verdict add(Death death);

  std::uint32_t count() const { return static_cast<std::uint32_t>(deaths_.size()); }
  const std::vector<Death>& deaths() const { return deaths_; }
  const Death& last() const { return deaths_.back(); }

 private:
  std::vector<Death> deaths_;
};

}  // namespace maide
