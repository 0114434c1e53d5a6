#include "maide/base/thread_team.hpp"

#include <sched.h>

#include <algorithm>
#include <system_error>

namespace maide {
namespace {

// Looks at the number before a thread sleeps: some ten microseconds.
constexpr int looks = 2000;

// Returns once `number` is no longer `old`.
void wait_for_change(const std::atomic<std::uint32_t>& number, std::uint32_t old) {
  for (int i = 0; i < looks; ++i) {
    if (number.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
  }
  number.wait(old, std::memory_order_acquire);
}

}  // namespace

unsigned processor_count() {
  cpu_set_t processors;
  if (::sched_getaffinity(0, sizeof processors, &processors) == 0) {
    return static_cast<unsigned>(std::max(1, CPU_COUNT(&processors)));
  }
  return std::max(1U, std::thread::hardware_concurrency());
}

ThreadTeam::~ThreadTeam() { stop(); }

void ThreadTeam::run(const std::function<void(unsigned)>& work) {
  if (start() == 1) {
    work(0);
    return;
  }
  work_ = &work;
  busy_.store(size_ - 1, std::memory_order_relaxed);
  begun_.fetch_add(1, std::memory_order_release);
  begun_.notify_all();
  do_work(0);
  while (const std::uint32_t busy = busy_.load(std::memory_order_acquire)) {
    wait_for_change(busy_, busy);
  }
  const auto error =
      std::ranges::find_if(errors_, [](const std::exception_ptr& one) { return one != nullptr; });
  if (error == errors_.end()) return;
  const std::exception_ptr first = *error;
  std::ranges::fill(errors_, nullptr);
  std::rethrow_exception(first);
}

unsigned ThreadTeam::start() {
  if (!threads_.empty()) return size_;
  errors_.resize(size_);
  threads_.reserve(size_ - 1);
  for (unsigned member = 1; member < size_; ++member) {
    try {
      threads_.emplace_back([this, member, done = begun_.load()] { serve(member, done); });
    } catch (const std::system_error&) {
      size_ = member;
    }
  }
  return size_;
}

void ThreadTeam::stop() {
  work_ = nullptr;
  begun_.fetch_add(1, std::memory_order_release);
  begun_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void ThreadTeam::serve(unsigned member, std::uint32_t done) {
  for (;; ++done) {
    wait_for_change(begun_, done);
    if (work_ == nullptr) return;
    do_work(member);
    if (busy_.fetch_sub(1, std::memory_order_release) == 1) busy_.notify_one();
  }
}

void ThreadTeam::do_work(unsigned member) {
  try {
    (*work_)(member);
  } catch (...) {
    errors_[member] = std::current_exception();
  }
}

}  // namespace maide
