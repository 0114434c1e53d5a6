#include "maide/base/run_control.hpp"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"

namespace maide {

void RunControl::check(std::string_view what) const {
  if (stop.stop_requested()) throw Interrupted(std::string(what) + " was interrupted");
  if (should_stop()) throw Interrupted(std::string(what) + " ran out of time");
}

// A signal handler may not call request_stop(), which takes locks and runs callbacks. So the
// handler writes a byte into a pipe (D. J. Bernstein's "self-pipe trick") and a thread that waits
// at the other end asks for the stop. Signals are not blocked: children would inherit that.

namespace {

std::atomic<int> pipe_in{-1};  // written to by the handler; -1: no Interrupt exists
std::atomic<int> signals_seen{0};
std::atomic<std::int64_t> first_signal_ms{0};  // 0: none, or it is just being handled
static_assert(std::atomic<int>::is_always_lock_free &&
                  std::atomic<std::int64_t>::is_always_lock_free,
              "used in a signal handler");

constexpr std::int64_t one_request_ms = 250;

constexpr char signal_byte = 's';
constexpr char end_byte = 'e';

// Never 0. clock_gettime() may be called in a signal handler.
std::int64_t now_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000 + 1;
}

extern "C" void on_signal(int) {
  const int saved_errno = errno;
  if (signals_seen.fetch_add(1) > 0) {
    const std::int64_t first = first_signal_ms;
    if (first != 0 && now_ms() - first > one_request_ms) {
      ::_exit(static_cast<int>(ExitStatus::inconclusive));
    }
    errno = saved_errno;
    return;
  }
  first_signal_ms = now_ms();
  // The pipe is empty, so the write cannot fail for want of room.
  if (::write(pipe_in.load(), &signal_byte, 1) != 1) {
    ::_exit(static_cast<int>(ExitStatus::inconclusive));
  }
  errno = saved_errno;
}

}  // namespace

class Interrupt::State {
 public:
  State() {
    int none = -1;
    if (!pipe_in.compare_exchange_strong(none, pipe_.write_end.get())) {
      throw std::logic_error("there is an Interrupt already");
    }
    signals_seen = 0;
    first_signal_ms = 0;
    watcher_ = std::thread([this] { watch(); });
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(SIGINT, &action, &earlier_int_);
    ::sigaction(SIGTERM, &action, &earlier_term_);
  }

  ~State() {
    ::sigaction(SIGINT, &earlier_int_, nullptr);
    ::sigaction(SIGTERM, &earlier_term_, nullptr);
    while (::write(pipe_.write_end.get(), &end_byte, 1) < 0 && errno == EINTR) {
    }
    watcher_.join();
    pipe_in = -1;
  }

  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  void watch() {
    for (;;) {
      char byte = 0;
      const ssize_t count = ::read(pipe_.read_end.get(), &byte, 1);
      if (count < 0 && errno == EINTR) continue;
      if (count != 1 || byte == end_byte) return;
      source_.request_stop();
    }
  }

  Pipe pipe_;
  std::stop_source source_;
  std::thread watcher_;
  struct sigaction earlier_int_ {};
  struct sigaction earlier_term_ {};
};

Interrupt::Interrupt() : state_(std::make_unique<State>()) {}
Interrupt::~Interrupt() = default;
std::stop_token Interrupt::token() const { return state_->token(); }

}  // namespace maide
