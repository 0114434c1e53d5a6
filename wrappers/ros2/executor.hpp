// kind=executor: an executor with subscriptions, timers, services and clients of one service. What
// becomes ready is one input each; what is run, and in which order, are the outputs.
//
//   arriveK   a message for subscription K arrives
//   dueK      timer K becomes due, by a clock that is put forward by hand
//   requestK  a request for service K arrives
//   askK      client K sends a request, which is served and answered at once: its answer arrives,
//   at
//             the other clients, too
//   spin      spin_once, spin_some or spin_all without waiting: `subK`, `timerK`, `serviceK`,
//             `clientK` for each callback that was run, or `nothing`
//
// With spin=forever the executor spins in a thread of its own. The same outputs say that a callback
// began; it runs until the input `end_subK`, `end_timerK`, `end_serviceK` or `end_clientK`.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "executor_parts.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "nodes.hpp"
#include "spinner.hpp"

namespace maide::ros2 {

struct ExecutorKindSettings {
  enum class Groups { one, own, reentrant };
  ExecutorSettings executor;
  std::size_t subscriptions = 2, timers = 0, services = 0, clients = 0;
  std::size_t depth = 10;
  std::optional<Spin> spin = Spin::once;  // none: forever
  Groups groups = Groups::one;
  bool intraprocess = false;

  static std::vector<OptionSpec> options();
  // Throws UsageError for an executor without callbacks.
  static ExecutorKindSettings from(const OptionValues& options);
};

SystemSetup executor_setup(const ExecutorKindSettings& settings);

// All names that any setting knows.
std::vector<std::string> executor_inputs();
std::vector<std::string> executor_events();

class ExecutorKind : public SystemInstance {
 public:
  ExecutorKind(Nodes& nodes, const ExecutorKindSettings& settings, EventSink& sink);
  ~ExecutorKind() override;
  void call(std::string_view input) override;
  void shutdown() override;

 private:
  using Message = std_msgs::msg::UInt64;
  using Type = rcl_interfaces::srv::GetParameters;
  struct Callback {
    std::string name;  // "sub1"
    std::size_t running = 0, ends = 0;
  };
  // All that takes long to delete.
  struct Ends {
    rclcpp::Node::SharedPtr sending, receiving;
    std::vector<rclcpp::CallbackGroup::SharedPtr> groups;
    std::vector<rclcpp::Publisher<Message>::SharedPtr> publishers;
    std::vector<rclcpp::Subscription<Message>::SharedPtr> subscriptions;
    std::vector<std::unique_ptr<ManualTimer>> timers;
    std::vector<rclcpp::Client<Type>::SharedPtr> clients;
    std::vector<rclcpp::Service<Type>::SharedPtr> services;
    std::vector<rclcpp::Client<Type>::SharedPtr> asking;  // run by the executor
    std::unique_ptr<Spinner> answering;                   // runs the service of these
    rclcpp::Service<Type>::SharedPtr asked;
    std::unique_ptr<rclcpp::Executor> executor;
    std::unique_ptr<SpinningThread> thread;  // of spin=forever
  };

  rclcpp::CallbackGroup::SharedPtr next_group();
  void make_subscription(const std::string& name);
  void make_timer();
  void make_service(const std::string& name);
  void make_clients(const std::string& name);
  bool is_matched() const;
  void wait_for_matches() const;
  void run(std::size_t callback);
  void ask(std::size_t client);
  void spin();
  void end(const std::string& name);

  Nodes& nodes_;
  const ExecutorKindSettings settings_;
  EventSink& sink_;
  const std::shared_ptr<Ends> ends_ = std::make_shared<Ends>();
  std::size_t groups_used_ = 0;
  std::size_t first_client_ = 0;  // callback
  std::size_t run_ = 0;           // callbacks since the call of `spin` began
  bool is_answered_ = false;      // what was asked last

  std::mutex mutex_;  // for what follows
  std::condition_variable ended_;
  std::vector<Callback> callbacks_;
  bool stopped_ = false;
};

}  // namespace maide::ros2
