// kind=nested: a synchronous call inside a callback. One or two subscriptions whose callbacks call
// a service and wait for its answer; client and server belong to callback groups that the user
// names, of an executor that spins.
//
//   triggerK  a message for callback K arrives: `beganK` when the callback begins. It is held there
//   callK     lets it go on: it sends its request and waits. `returnedK` when it got its answer and
//             ended, `exceptionK` if the call throws
//   timeoutK  the wait of callback K gives up: `timed_outK`
//   look      `hangs` if a callback waits and no other is held, `waits` if another is, else `idle`
//
// A callback is triggered only when it does not run; call and timeout are possible only where they
// mean something.
//
// An input is given only when all threads are asleep. So `hangs` is an observation: the callback
// waits for something that nobody in the process is going to do.
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "executor_parts.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "nodes.hpp"

namespace maide::ros2 {

struct NestedSettings {
  ExecutorSettings executor;
  std::size_t callers = 1;
  // Names of groups: a, b, c are exclusive, `reentrant` is what it says; of the server also
  // `elsewhere`: an executor of its own.
  std::array<std::string, 2> caller_groups;
  std::string client_group, server_group;
  bool spins = false;  // the call spins the executor instead of waiting

  static std::vector<OptionSpec> options();
  static NestedSettings from(const OptionValues& options);
};

SystemSetup nested_setup(const NestedSettings& settings);

// All names that any setting knows.
std::vector<std::string> nested_inputs();
std::vector<std::string> nested_events();

class Nested : public SystemInstance {
 public:
  Nested(Nodes& nodes, const NestedSettings& settings, EventSink& sink);
  ~Nested() override;
  void call(std::string_view input) override;
  void shutdown() override;

 private:
  using Message = std_msgs::msg::UInt64;
  using Type = rcl_interfaces::srv::GetParameters;
  // One callback that calls, and how many runs of it are held and let go, wait, and give up.
  struct Caller {
    std::string suffix;  // "1"
    std::size_t held = 0, released = 0, waiting = 0, given_up = 0;
    rclcpp::Publisher<Message>::SharedPtr publisher;
    rclcpp::Subscription<Message>::SharedPtr subscription;
  };
  // All that takes long to delete.
  struct Ends {
    rclcpp::Node::SharedPtr sending, receiving;
    std::map<std::string, rclcpp::CallbackGroup::SharedPtr> groups;
    std::vector<std::unique_ptr<Caller>> callers;
    rclcpp::Client<Type>::SharedPtr client;
    rclcpp::Service<Type>::SharedPtr server;
    std::unique_ptr<rclcpp::Executor> executor, elsewhere;
    std::unique_ptr<SpinningThread> thread, elsewhere_thread;
  };

  void make_groups_of_executor();
  void make_caller(std::size_t number, const std::string& topic);
  void wait_for_matches() const;
  void run(Caller& caller);
  void make_call(Caller& caller, std::unique_lock<std::mutex>& lock);
  void spin_for_answer(Caller& caller);
  void look();

  Nodes& nodes_;
  const NestedSettings settings_;
  EventSink& sink_;
  const std::shared_ptr<Ends> ends_ = std::make_shared<Ends>();

  std::mutex mutex_;  // for what follows, and for the numbers of the callers
  std::condition_variable changed_;
  bool stopped_ = false;
};

}  // namespace maide::ros2
