#include "spinner.hpp"

#include <chrono>

namespace maide::ros2 {
namespace {

rclcpp::ExecutorOptions in_context_of(const rclcpp::Node::SharedPtr& node) {
  rclcpp::ExecutorOptions options;
  options.context = node->get_node_base_interface()->get_context();
  return options;
}

}  // namespace

Spinner::Spinner(const rclcpp::Node::SharedPtr& node)
    : node_(node),
      group_(node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, false)),
      executor_(in_context_of(node)) {}

void Spinner::add_group() {
  if (is_added_) return;
  is_added_ = true;
  executor_.add_callback_group(group_, node_->get_node_base_interface());
}

void Spinner::run_ready(Spin spin) {
  using std::chrono::nanoseconds;
  if (stopped_) return;
  add_group();
  switch (spin) {
    case Spin::once: executor_.spin_once(nanoseconds(0)); return;
    case Spin::some: executor_.spin_some(nanoseconds(0)); return;
    case Spin::all: executor_.spin_all(nanoseconds(0)); return;
  }
}

void Spinner::run_until(const std::function<bool()>& is_done) {
  add_group();
  while (!stopped_ && !is_done()) executor_.spin_once();
}

// A cancel that comes before the wait makes it return at once.
void Spinner::stop() {
  stopped_ = true;
  executor_.cancel();
}

}  // namespace maide::ros2
