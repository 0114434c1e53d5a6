// The system call in which a thread sleeps, as /proc/.../syscall tells it, and whether that call
// will end by itself. A wait with a time limit has the limit in the thread's own memory. For a
// futex (condition variables, timed mutexes, semaphores) the limit is a point in time. Once it is
// past, the thread is about to run, even if its timer's interrupt is late. On a virtual machine
// beside others the interrupt may be late by longer than an observation takes. For poll, select and
// epoll_wait the limit counts from a beginning that nobody can see.
//
// A call may be remembered for as long as its thread has not run, because the thread cannot have
// made another. Whether the limit is past has to be asked each time.
#pragma once

#include <sys/types.h>
#include <time.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace maide {

class BlockedCall {
 public:
  enum class Kind : std::uint8_t {
    running,      // in none: on a CPU or on its way to one
    timed_sleep,  // nanosleep: goes on by itself
    waiting,      // for someone else, or for a time
  };

  // `text` is what the file says of `thread`, in any process whose memory we may read; where we may
  // not, a limit reads as none. Some 1 us where there is a limit.
  static BlockedCall parse(std::string_view text, pid_t thread);

  BlockedCall() = default;
  Kind kind() const { return kind_; }
  // The time that it waits for has come, by the clock as it is now.
  bool is_overdue() const;

 private:
  struct Limit {
    clockid_t clock;
    timespec time;
  };
  explicit BlockedCall(Kind kind) : kind_(kind) {}
  static std::optional<Limit> read_limit(std::string_view arguments, pid_t thread);

  Kind kind_ = Kind::running;
  std::optional<Limit> limit_;
};

}  // namespace maide
