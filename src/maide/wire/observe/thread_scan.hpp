// Tells whether all threads of the system's processes are asleep at the same instant: those of this
// process, and of others that it is told to watch. No single call tells that to user space, so two
// passes over the threads do. The first pass knows of each thread that it is blocked, and how often
// it was ever put on a CPU. (The kernel prints a thread's system call only once it is off its CPU
// and dequeued.) The second pass finds it still in state S and never run since. Then every thread
// slept at each moment between the two passes. Reading the state twice would prove less: a thread
// that was preempted on its way to sleep reads S.
//
// The call in which a thread was blocked is remembered for as long as its run count stays the same.
// Its state is never remembered: a thread that is woken and has not run yet has an old count and a
// new state. The list of threads is remembered for as long as the kernel counts as many and all of
// them are alive. docs/design/quiescence.md says why no verdict becomes wrong by that.
#pragma once

#include <sys/types.h>
#include <time.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

namespace maide {

// The system call in which a thread sleeps, as /proc/.../syscall tells it, and whether that call
// will end by itself. A wait with a time limit has the limit in the thread's own memory. For a
// futex (condition variables, timed mutexes, semaphores) the limit is a point in time. Once it is
// past, the thread is about to run, even if its timer's interrupt is late. On a virtual machine
// beside others the interrupt may be late by longer than an observation takes. For poll, select and
// epoll_wait the limit counts from a beginning that nobody can see.
//
// A call may be remembered for as long as its thread has not run, because the thread cannot have
// made another. Whether the limit is past has to be asked each time.
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

// The calling thread belongs to the SDK and not to the system, until this object dies: thread scans
// leave it out. The thread that scans is always left out.
class SdkThread {
 public:
  SdkThread();
  ~SdkThread();
  SdkThread(const SdkThread&) = delete;
  SdkThread& operator=(const SdkThread&) = delete;

 private:
  pid_t thread_;
};

class ThreadScan {
 public:
  // Throws UsageError where the kernel does not show what is needed (no /proc, no run counts).
  ThreadScan();
  ~ThreadScan();
  ThreadScan(const ThreadScan&) = delete;
  ThreadScan& operator=(const ThreadScan&) = delete;

  // All threads of that process belong to the system too. As long as it is gone nothing is asleep.
  void watch_process(pid_t process);

  // First pass. False if a thread is not asleep, if its time limit is past (BlockedCall), or
  // if it sleeps only for a set time (nanosleep) and that is not `timed_sleep_is_rest`. Cost: two
  // system calls for each thread that ran of late, one for each process.
  bool begin(bool timed_sleep_is_rest = false);
  // Second pass, after begin() said true: false if a thread has run since, is about to, has come or
  // gone. Two system calls a thread, one a process.
  bool end();

 private:
  struct Entry;
  struct Process;
  bool list_threads(std::vector<pid_t>& threads);
  bool counts_threads();
  bool has_listed_threads() const;
  bool know_threads();
  bool is_asleep(Entry& entry, bool timed_sleep_is_rest) const;
  bool has_slept_on(Entry& entry) const;
  void look_first_at(std::size_t place);

  std::vector<std::unique_ptr<Process>> processes_;  // this one first
  bool shows_syscall_;   // else the first pass has to trust the state's letter
  bool counts_threads_;  // a folder of threads tells how many it lists; else it is read each time
  bool is_list_known_ = false;          // entries_ are the threads that were listed last
  std::uint64_t own_threads_ = 0;       // which SDK threads were left out then (a generation)
  std::thread::id scanning_thread_;     // likewise
  std::vector<pid_t> threads_, again_;  // as listed
  std::vector<std::unique_ptr<Entry>> entries_;  // of these, those that ran last first
};

}  // namespace maide
