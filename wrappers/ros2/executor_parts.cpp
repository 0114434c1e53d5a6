#include "executor_parts.hpp"

#include <algorithm>
#include <memory>

namespace maide::ros2 {

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
