// A single-threaded executor with one callback group: what an actor spins with. The actor's thread
// alone calls it, but for stop().
#pragma once

#include <atomic>
#include <functional>
#include <rclcpp/rclcpp.hpp>

namespace maide::ros2 {

// How a program that does not want to wait runs what is ready.
enum class Spin { once, some, all };

class Spinner {
 public:
  explicit Spinner(const rclcpp::Node::SharedPtr& node);

  // The group of the callbacks that are run here.
  const rclcpp::CallbackGroup::SharedPtr& group() const { return group_; }

  // Runs what is ready, without waiting: one callback, one of each, or until nothing is left.
  void run_ready(Spin spin);
  // Runs callbacks until `is_done` says true after one of them, or stop().
  void run_until(const std::function<bool()>& is_done);
  // From another thread: waits end, now and later.
  void stop();

 private:
  // At the first call, when the group has its ends, as in programs. From rclcpp 28 on an executor
  // sees an end that comes later by its second look only.
  void add_group();

  rclcpp::Node::SharedPtr node_;  // lives as long as its group
  rclcpp::CallbackGroup::SharedPtr group_;
  rclcpp::executors::SingleThreadedExecutor executor_;
  bool is_added_ = false;
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::ros2
