// One live connection to a wrapper: where the wrapper is (`WrapperEndpoint`), lines out and lines
// in (`WrapperConnection`), and what its deaths prove (`DeathRecord`). Nothing here knows what the
// lines say.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/protocol/line_io.hpp"

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
