#include "held_executor.hpp"

#include <chrono>
#include <utility>

namespace maide::ros2 {
namespace {

const void* what_of(const rclcpp::AnyExecutable& next) {
  if (next.timer) return next.timer.get();
  if (next.subscription) return next.subscription.get();
  if (next.service) return next.service.get();
  return next.client.get();
}

}  // namespace

HeldExecutor::HeldExecutor(const rclcpp::ExecutorOptions& options, std::size_t threads,
                           OnPick on_pick, IsForNobody is_for_nobody)
    : rclcpp::Executor(options),
      thread_count_(threads),
      on_pick_(std::move(on_pick)),
      is_for_nobody_(std::move(is_for_nobody)) {}

HeldExecutor::~HeldExecutor() { stop(); }

void HeldExecutor::spin() {
  spinning.store(true);
  for (std::size_t thread = 0; thread < thread_count_; ++thread) {
    threads_.emplace_back([this] { run(); });
  }
}

bool HeldExecutor::wait_for(const std::function<bool()>& condition) {
  std::unique_lock lock(mutex_of_holds_);
  changed_.wait(lock, [&] { return is_stopped_ || condition(); });
  return !is_stopped_;
}

void HeldExecutor::run() {
  bool goes_on = false;  // behind an answer that nobody waits for, as in the loop
  for (;;) {
    bool is_free = false;
    const auto may_pick = [&] {
      is_free = is_free_;
      if (is_free || goes_on) return true;
      if (picks_ == 0) return false;
      --picks_;
      return true;
    };
    if (!wait_for(may_pick)) return;
    rclcpp::AnyExecutable next;
    bool is_found = false;
    {
      const std::scoped_lock waiting(mutex_of_waiting_);
      if (!spinning.load()) return;
      is_found = get_next_executable(next, std::chrono::nanoseconds(is_free ? -1 : 0));
    }
    const void* const what = is_found ? what_of(next) : nullptr;
    goes_on = is_found && next.client && is_for_nobody_(what);
    if (!goes_on && !is_free) on_pick_(what);
    if (!is_found) continue;
    const auto may_start = [&] {
      std::size_t& starts = starts_[what];
      if (starts > 0) return --starts, true;
      return is_free_;
    };
    if (!goes_on && !is_free && !wait_for(may_start)) return;
    execute_any_executable(next);
    next.callback_group.reset();  // as in MultiThreadedExecutor: it was given back
  }
}

void HeldExecutor::pick() {
  const std::scoped_lock lock(mutex_of_holds_);
  ++picks_;
  changed_.notify_all();
}

void HeldExecutor::start(const void* picked) {
  const std::scoped_lock lock(mutex_of_holds_);
  ++starts_[picked];
  changed_.notify_all();
}

void HeldExecutor::set_free() {
  const std::scoped_lock lock(mutex_of_holds_);
  is_free_ = true;
  changed_.notify_all();
}

void HeldExecutor::stop() {
  {
    const std::scoped_lock lock(mutex_of_holds_);
    if (is_stopped_) return;
    is_stopped_ = true;
    changed_.notify_all();
  }
  if (threads_.empty()) return;
  cancel();
  threads_.clear();
}

}  // namespace maide::ros2
