#include "executor_parts.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>

namespace maide::ros2 {
namespace {

constexpr std::int64_t period = 1'000'000'000;

void set_time(const rclcpp::Clock::SharedPtr& clock, std::int64_t now) {
  const std::scoped_lock lock(clock->get_clock_mutex());
  if (rcl_set_ros_time_override(clock->get_clock_handle(), now) != RCL_RET_OK) {
    throw std::runtime_error("rcl_set_ros_time_override fails");
  }
}

}  // namespace

std::vector<OptionSpec> ExecutorSettings::options() {
  return {OptionSpec::choice("executor", "single", {"single", "multi"},
                             "SingleThreadedExecutor or MultiThreadedExecutor"),
          OptionSpec::integer("threads", 2, 1, 8, "threads of executor=multi")};
}

ExecutorSettings ExecutorSettings::from(const OptionValues& options) {
  return {options.is("executor", "multi"), static_cast<std::size_t>(options.number("threads"))};
}

std::unique_ptr<rclcpp::Executor> make_executor(const ExecutorSettings& settings,
                                                const rclcpp::Node::SharedPtr& node) {
  rclcpp::ExecutorOptions options;
  options.context = node->get_node_base_interface()->get_context();
  if (!settings.is_multi) {
    return std::make_unique<rclcpp::executors::SingleThreadedExecutor>(options);
  }
  return std::make_unique<rclcpp::executors::MultiThreadedExecutor>(options, settings.threads);
}

std::vector<rclcpp::CallbackGroup::SharedPtr> make_groups(const rclcpp::Node::SharedPtr& node,
                                                          std::size_t count,
                                                          rclcpp::CallbackGroupType type) {
  std::vector<rclcpp::CallbackGroup::SharedPtr> groups;
  for (std::size_t group = 0; group < count; ++group) {
    groups.push_back(node->create_callback_group(type, false));
  }
  std::sort(groups.begin(), groups.end(), std::owner_less<>());
  return groups;
}

// Half a period is past, so that a clock that is put forward by one is never at a point at which
// the timer is due once more.
ManualTimer::ManualTimer(const rclcpp::Node::SharedPtr& node, std::function<void()> callback,
                         const rclcpp::CallbackGroup::SharedPtr& group)
    : clock_(std::make_shared<rclcpp::Clock>(RCL_ROS_TIME)), now_(period / 2) {
  if (rcl_enable_ros_time_override(clock_->get_clock_handle()) != RCL_RET_OK) {
    throw std::runtime_error("rcl_enable_ros_time_override fails");
  }
  timer_ = rclcpp::create_timer(node->get_node_base_interface(), node->get_node_timers_interface(),
                                clock_, rclcpp::Duration(std::chrono::nanoseconds(period)),
                                std::move(callback), group);
  set_time(clock_, now_);
}

void ManualTimer::make_due() {
  now_ += period;
  set_time(clock_, now_);
}

SpinningThread::SpinningThread(rclcpp::Executor& executor)
    : executor_(executor), thread_([&executor] { executor.spin(); }) {}

// An executor that has not begun to spin does not hear of it the first time.
void SpinningThread::stop() {
  if (!thread_.joinable()) return;
  while (!executor_.is_spinning()) std::this_thread::yield();
  executor_.cancel();
  thread_.join();
}

}  // namespace maide::ros2
