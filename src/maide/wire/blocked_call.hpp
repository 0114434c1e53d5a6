// The system call in which a thread sleeps, as /proc/.../syscall tells it, and whether it will end
// by itself. What a thread waits for with a time limit lies in its own memory: of a futex
// (condition variables, timed mutexes, semaphores) the limit is a point in time, and once that is
// past the thread is about to run, though the timer's interrupt may be late by as long as its
// processor is slow to wake: on a virtual machine beside others, longer than an observation takes.
// The limits of poll, select and epoll_wait count from a beginning that nobody can see.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string_view>

namespace maide {

enum class BlockedCall : std::uint8_t {
  running,      // in none: on a CPU or on its way to one, or its time limit is past
  timed_sleep,  // nanosleep: goes on by itself
  waiting,      // for someone else, or for a time that has not come
};

// `text` is what the file says of `thread`, in any process whose memory we may read; where we may
// not, a limit that is past reads as one that has not come. Some 1 us where there is a limit.
BlockedCall parse_blocked_call(std::string_view text, pid_t thread);

}  // namespace maide
