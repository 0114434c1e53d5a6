// Where a wrapper is, and one live connection to it: lines out, lines in, and a plain sentence
// about how it ended. Knows nothing of what the lines say.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/descriptor.hpp"
#include "maide/wire/child_process.hpp"
#include "maide/wire/line_io.hpp"

namespace maide {

// A wrapper that is to be started, or one that listens.
class WrapperEndpoint {
 public:
  // `argv[0]` is found on PATH unless it has a '/'. `name` is for messages; "" makes one of argv.
  static WrapperEndpoint program(std::vector<std::string> argv, std::string name = "");
  // Throws UsageError if it is not HOST:PORT. `token` is "" if there is none.
  static WrapperEndpoint tcp(const std::string& host_port, std::string token = "");

  const std::string& name() const { return name_; }
  bool is_tcp() const { return argv_.empty(); }
  const std::vector<std::string>& argv() const { return argv_; }
  const std::string& host_port() const { return host_port_; }
  const std::string& token() const { return token_; }

 private:
  std::vector<std::string> argv_;
  std::string host_port_, token_, name_;
};

// The wrapper is gone. what(): "exited with status 3: its last words", "closed the connection".
class ConnectionLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class WrapperConnection {
 public:
  // Starts the wrapper, or connects to it. `should_stop` is asked a few times a second. Throws
  // WrapperError if that fails.
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

}  // namespace maide
