// Threads that do one piece of work after another together. Between two pieces they sleep, after
// a short wait awake, since the next piece often comes at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace maide {

// The processors that this process may use; at least 1.
unsigned processor_count();

class ThreadTeam {
 public:
  // A team of `size` members, at least 1. The caller of run() is one, the others are threads.
  explicit ThreadTeam(unsigned size) : size_(size) {}
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;
  ~ThreadTeam();

  unsigned size() const { return size_; }

  // Starts the threads, if they are not started. Where the system allows fewer, the team is smaller
  // from now on. Returns its size.
  unsigned start();

  // Calls work(member) with each number below size(), all at once, and returns when all have
  // returned. What they wrote is seen by the caller, and by the next work. If any of them threw,
  // the exception of the least is thrown. One caller at a time. Starts the threads.
  void run(const std::function<void(unsigned)>& work);

 private:
  void stop();
  void serve(unsigned member, std::uint32_t done);
  void do_work(unsigned member);

  unsigned size_;
  std::vector<std::thread> threads_;
  const std::function<void(unsigned)>* work_ = nullptr;  // null: the threads end
  std::vector<std::exception_ptr> errors_;               // by member
  std::atomic<std::uint32_t> begun_ = 0;                 // pieces of work
  std::atomic<std::uint32_t> busy_ = 0;                  // threads at the present one
};

}  // namespace maide
