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
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/protocol.hpp"
#include "maide/wire/protocol/tcp.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"

namespace maide {

class WrapperServer {
 public:
  // Speaks over two descriptors, which may be the same (a socket), and which stay the caller's.
  // `received`: hello has been said, and this has been read (see Reception). `on_configured` is
  // called once the system is set up.
  WrapperServer(SystemWrapper& wrapper, int in, int out, std::optional<std::string> received = {},
                std::function<void()> on_configured = {});
  ~WrapperServer();
  WrapperServer(const WrapperServer&) = delete;
  WrapperServer& operator=(const WrapperServer&) = delete;

  // Serves until the client says bye or goes away. Ends the process if the system cannot be reset
  // or unblocked any more. Returns why this wrapper is of no use for the client (it has refused the
  // wrapper, or the options cannot be set), else "".
  std::string serve();

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
  std::function<void()> on_configured_;
  std::string refusal_;  // what serve() returns
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

// Of a wrapper that listens: it says hello, and waits for each client's token and options.
ReceptionRules rules_for_clients(const WrapperDescription& description,
                                 std::optional<std::string> token);

}  // namespace maide
