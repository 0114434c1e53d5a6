// kind=nodes: the nodes of a system file on executors that are held (held_executor.hpp). Each
// callback does what it is told, call by call, in the thread of the executor that runs it. So the
// order of the calls is the word's, and what can run at all is rclcpp's. For maide replay; the
// inputs are in held_graph.hpp.
#pragma once

#include <rmw/rmw.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "executor_parts.hpp"
#include "held_executor.hpp"
#include "held_graph.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "nodes.hpp"
#include "spinner.hpp"

namespace maide::ros2 {

class HeldSystem : public SystemInstance {
 public:
  HeldSystem(Nodes& nodes, const HeldGraph& graph, EventSink& sink);
  ~HeldSystem() override;
  void call(std::string_view input) override;
  void shutdown() override;

 private:
  using Message = std_msgs::msg::UInt64;
  using Type = rcl_interfaces::srv::GetParameters;
  using Call = std::function<void()>;
  using End = std::pair<std::size_t, std::size_t>;  // a node, and a topic or service

  // A request that was served, and the node that sent it.
  struct Served {
    rmw_request_id_t id;
    std::size_t client = 0;
  };
  // One run of a callback.
  struct Run {
    std::string prefix;  // "c0.1."
    Call next;           // what it does as soon as it is held
    bool is_running = false, is_over = false;
    std::map<std::size_t, std::shared_ptr<bool>> answers;  // to its last request, by service
    std::optional<Served> served;
  };
  struct Callback {
    const void* picked = nullptr;  // the timer, subscription, service or client
    std::vector<Run> runs;
    std::size_t next_run = 0;  // that starts next
    std::uint64_t newest = 0;  // message
  };
  // Of a program: what it receives by, and what came.
  struct Receiver {
    explicit Receiver(const rclcpp::Node::SharedPtr& node) : spinner(node) {}
    Spinner spinner;
    bool has_received = false;
    std::uint64_t newest = 0;
    std::string label;  // of the message
    std::optional<Served> served;
  };
  // All that takes long to delete.
  struct Ends {
    std::vector<rclcpp::Node::SharedPtr> nodes;
    std::vector<rclcpp::CallbackGroup::SharedPtr> groups;
    std::map<End, rclcpp::Publisher<Message>::SharedPtr> publishers;
    std::vector<std::pair<std::size_t, rclcpp::Subscription<Message>::SharedPtr>> subscriptions;
    std::map<End, rclcpp::Client<Type>::SharedPtr> clients;
    std::vector<rclcpp::Service<Type>::SharedPtr> services;  // by service
    std::vector<std::shared_ptr<ManualTimer>> timers;
    std::map<End, std::unique_ptr<Receiver>> readers, askers;
    std::map<std::size_t, std::unique_ptr<Receiver>> servers;  // by service
    std::vector<std::unique_ptr<HeldExecutor>> executors;
  };

  void make_groups();
  void make_executors();
  void make_callback(std::size_t number);
  void make_timer(std::size_t number);
  void make_subscription(std::size_t number);
  void make_server(std::size_t number);
  void make_client(std::size_t node, std::size_t service,
                   const rclcpp::CallbackGroup::SharedPtr& group);
  void make_ends_of_topics();
  void make_ends_of_services();
  void make_calls_of_callbacks();
  void make_calls_of_programs();
  bool is_matched() const;
  void wait_for_matches() const;

  // Of a callback's run: it is made by the run, which then is held again.
  void add_call(std::size_t callback, std::size_t run, const std::string& name, Call call);
  void run(std::size_t callback, const std::string& event,
           const std::optional<Served>& served = std::nullopt);
  void send(std::size_t node, std::size_t service, const std::shared_ptr<bool>& answer);
  void wait_for(Run& run, std::size_t service);
  std::optional<Served>& served_for(std::size_t service, Run& run);
  void answer(std::size_t service, std::optional<Served>& served);
  bool takes_for_nobody(const void* client);
  void publish(const End& end);
  void receive(Receiver& receiver, const std::string& event);
  const char* label_of(std::size_t topic, std::uint64_t message, std::uint64_t& newest) const;

  Nodes& nodes_;
  const HeldGraph& graph_;
  EventSink& sink_;
  const std::string name_;
  const bool takes_one_by_one_ =
      std::string_view(rmw_get_implementation_identifier()) == "rmw_fastrtps_cpp";
  const std::shared_ptr<Ends> ends_ = std::make_shared<Ends>();
  std::map<std::string, Call, std::less<>> calls_;  // by input
  std::map<const void*, std::size_t> callback_of_;  // by what executors pick
  std::map<End, std::size_t> callback_of_client_;   // of nodes
  std::vector<std::uint64_t> written_;              // by topic

  std::mutex mutex_;  // for what follows
  std::condition_variable changed_;
  std::vector<Callback> callbacks_;
  // By client of a node: its answers that were sent and not taken, and whether they are its own.
  std::map<const void*, std::deque<bool>> answers_;
  bool is_stopped_ = false;
};

}  // namespace maide::ros2
