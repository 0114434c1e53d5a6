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

#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

namespace maide {

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

  // First pass. False if a thread is not asleep, if its time limit is past (blocked_call.hpp), or
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
