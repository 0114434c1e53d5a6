// Work whose end only its result shows: a token that goes from thread to thread through condition
// variables, with random amounts of computing in between.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "maide/base/random.hpp"

namespace maide::test {

class ThreadChain {
 public:
  explicit ThreadChain(std::size_t threads, std::uint64_t seed) {
    for (std::size_t place = 0; place < threads; ++place) {
      threads_.emplace_back(
          [this, place, random = Random(seed + place)]() mutable { work(place, random); });
    }
  }
  ~ThreadChain() {
    {
      const std::scoped_lock lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  ThreadChain(const ThreadChain&) = delete;
  ThreadChain& operator=(const ThreadChain&) = delete;

  // Lets the token go this many times from hand to hand; returns at once.
  void start(std::size_t steps) {
    const std::scoped_lock lock(mutex_);
    left_ = steps;
    changed_.notify_all();
  }
  bool is_done() {
    const std::scoped_lock lock(mutex_);
    return left_ == 0;
  }

 private:
  void work(std::size_t place, Random& random) {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return ending_ || (left_ > 0 && holder_ == place); });
      if (ending_) return;
      const std::uint64_t spins = random.chance(0.1) ? random.below(100'000) : random.below(500);
      lock.unlock();
      for (volatile std::uint64_t i = 0; i < spins;) i = i + 1;
      if (random.chance(0.2)) std::this_thread::yield();
      lock.lock();
      holder_ = (holder_ + 1) % threads_.size();
      --left_;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t holder_ = 0, left_ = 0;
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace maide::test
