// The wrapper's side of the protocol over one connection. One thread reads lines, so that a
// cancellation, or the client's end, is seen while a word plays. The calling thread plays words and
// answers, in the order in which they came.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/protocol.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"

namespace maide {

class WrapperServer {
 public:
  // Speaks over two descriptors, which may be the same (a socket), and which stay the caller's.
  // `received`: hello has been said, and this has been read (see Reception).
  WrapperServer(SystemWrapper& wrapper, int in, int out, std::optional<std::string> received = {});
  ~WrapperServer();
  WrapperServer(const WrapperServer&) = delete;
  WrapperServer& operator=(const WrapperServer&) = delete;

  // Serves until the client says bye or goes away. Ends the process if the system cannot be reset
  // or unblocked any more.
  void serve();

 private:
  struct Line {
    std::uint64_t number = 0;
    std::string text;
    std::chrono::steady_clock::time_point arrived;
  };
  enum class Next : std::uint8_t { go_on, stop };

  // `bytes` were read before.
  void read_lines(std::string bytes);
  void push(std::string line);
  void cancel();
  void end_reading(std::string problem);
  std::optional<Line> pop();
  Next handle(const Line& line);
  void serve_lines();
  Next configure(const protocol::Configure& message);
  void run(const protocol::Run& message, const Line& line);
  void prepare_next();
  void send(const std::string& line);
  void send_error(protocol::ErrorCode code, const std::string& message,
                  std::optional<std::uint64_t> id = {});
  void end_instance();
  [[noreturn]] void leave(const std::string& reason);

  static constexpr std::uint64_t no_query = ~std::uint64_t{0};

  int in_, out_;
  std::mutex output_mutex_;
  Watchdog watchdog_;
  WrapperSession session_;
  std::atomic<std::uint64_t> playing_ = no_query;  // the query that is not answered yet

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Line> lines_;
  std::uint64_t received_ = 0;                    // lines so far
  std::atomic<std::uint64_t> cancelled_up_to_{};  // queries in lines up to this are not wanted
  bool ended_ = false;                            // nothing more will come
  std::string problem_;                           // why, if not in good order
  bool stopping_ = false;
  std::thread reader_;
};

// What a wrapper says of itself first.
protocol::Hello hello_of(const WrapperDescription& description, bool needs_token);

// Where clients of a listening wrapper wait until they are worth a process. The wrapper says hello,
// and the token and the options must come within ten seconds. One thread does all of it, with a
// descriptor for each client that waits, 256 at most. A newcomer takes the place of the client that
// has been silent longest, so a crowd of silent connections keeps no client out that speaks.

struct ReceptionSettings {
  std::size_t most_waiting = 256;           // connections whose options have not been read
  std::chrono::milliseconds limit{10'000};  // for the token and the options
};

// A client that has named the token, if one is needed, and sent its options.
struct AcceptedClient {
  Descriptor socket;     // blocks
  std::string received;  // all that it sent so far
};

class Reception {
 public:
  // `listener`, a listening socket, stays the caller's, but does not block any more.
  Reception(int listener, const WrapperDescription& description, std::optional<std::string> token,
            ReceptionSettings settings = {});

  // Waits until something happens, at most so long, or for ever without a limit. Takes new
  // connections, reads, and drops connections that are late, wrong or too many. Throws UsageError
  // if the listener takes no connections any more. O(connections).
  void wait(std::optional<std::chrono::milliseconds> limit);
  // The client that has waited longest of those that are ready, if there is one.
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
  std::optional<std::string> token_;
  ReceptionSettings settings_;
  std::string hello_;           // the line
  std::list<Waiting> waiting_;  // the oldest first
};

// Equal, in a time that depends on the lengths only.
bool equal_in_constant_time(std::string_view left, std::string_view right);

}  // namespace maide
