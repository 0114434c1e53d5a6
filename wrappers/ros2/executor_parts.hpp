// What the kinds of system that spin have in common: an executor, the thread that spins it, and the
// callback groups that it looks through.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <thread>
#include <vector>

#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::ros2 {

struct ExecutorSettings {
  bool is_multi = false;    // MultiThreadedExecutor, else SingleThreadedExecutor
  std::size_t threads = 2;  // of the former

  static std::vector<OptionSpec> options();
  static ExecutorSettings from(const OptionValues& options);
};

std::unique_ptr<rclcpp::Executor> make_executor(const ExecutorSettings& settings,
                                                const rclcpp::Node::SharedPtr& node);

// New groups of the node, in the order in which executors look through them: that of their
// addresses. Whoever hands them out in this order has callbacks that come in the same order in
// every word.
std::vector<rclcpp::CallbackGroup::SharedPtr> make_groups(
    const rclcpp::Node::SharedPtr& node, std::size_t count,
    rclcpp::CallbackGroupType type = rclcpp::CallbackGroupType::MutuallyExclusive);

// A timer that becomes due when it is told so: its clock is put forward by hand.
class ManualTimer {
 public:
  // Throws std::runtime_error.
  ManualTimer(const rclcpp::Node::SharedPtr& node, std::function<void()> callback,
              const rclcpp::CallbackGroup::SharedPtr& group);
  void make_due();
  // What executors know it by.
  const void* timer() const { return timer_.get(); }

 private:
  rclcpp::Clock::SharedPtr clock_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::int64_t now_ = 0;  // of the clock, in nanoseconds
};

// A thread that spins an executor until it is stopped.
class SpinningThread {
 public:
  explicit SpinningThread(rclcpp::Executor& executor);
  ~SpinningThread() { stop(); }
  SpinningThread(const SpinningThread&) = delete;
  SpinningThread& operator=(const SpinningThread&) = delete;
  // Returns when no callback runs any more.
  void stop();

 private:
  rclcpp::Executor& executor_;
  std::jthread thread_;
};

}  // namespace maide::ros2
