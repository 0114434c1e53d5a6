// Are all threads of the system's processes (this one, and those it is told to watch) asleep, all
// at the same instant? Nothing that user space can ask answers that in one call, so two passes over
// /proc/self/task do: the first proves of each thread that it is blocked (the kernel prints a
// thread's system call only once it is off its CPU and dequeued) and notes how often it was ever
// put on a CPU; the second finds it still in state S and never run since. Then every thread slept
// at each moment between the two passes. Stronger than reading the state twice: a thread that was
// preempted on its way to sleep reads S.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
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

  // First pass: false if a thread is not asleep, or its time limit is past (blocked_call.hpp), or
  // it sleeps only for a set time (nanosleep) and that is not `timed_sleep_is_rest`.
  bool begin(bool timed_sleep_is_rest = false);
  // Second pass, after begin() said true: false if a thread has run since, is about to, has come or
  // gone. Some 3 to 8 microseconds a thread for both passes.
  bool end();

 private:
  struct Entry;
  struct Process;
  bool list_threads(std::vector<pid_t>& threads);
  Entry* find(pid_t thread);

  std::vector<std::unique_ptr<Process>> processes_;  // this one first
  bool shows_syscall_;  // else the first pass has to trust the state's letter
  std::vector<pid_t> threads_, again_;
  std::vector<std::unique_ptr<Entry>> entries_;  // descriptors kept open, by thread
};

}  // namespace maide
