// Publishers and subscribers of a topic of their own, connected: what one word is played on.
#pragma once

#include <ros/callback_queue.h>
#include <ros/publisher.h>
#include <std_msgs/UInt64.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "node.hpp"
#include "queues.hpp"
#include "subscriber_end.hpp"

namespace maide::ros1 {

// Callback queues without a subscriber. One leaves something behind in each thread that ever called
// its callbacks, so they are used again.
using IdleQueues = std::vector<std::unique_ptr<ros::CallbackQueue>>;

class Ros1Connection : public SystemInstance {
 public:
  // When the connection ends its callback queue goes to `idle`. Throws std::runtime_error.
  Ros1Connection(Node& node, const Queues& queues, EventSink& sink, IdleQueues& idle);
  ~Ros1Connection() override;

  void call(std::string_view input) override;
  void shutdown() override;
  bool polls_in_vain() const override;

 private:
  struct Subscriber {
    std::unique_ptr<ros::CallbackQueue> callbacks;
    std::unique_ptr<SubscriberEnd> end;  // none if disconnected
    bool received = false;               // by the read that is going on
  };
  void connect(Subscriber& subscriber);
  void publish(std::size_t messages);
  void read(Subscriber& subscriber);
  void try_read(Subscriber& subscriber);

  Node& node_;
  const Queues queues_;
  EventSink& sink_;
  IdleQueues& idle_;
  const std::string topic_;
  std::vector<ros::Publisher> publishers_;
  std::vector<Subscriber> subscribers_;
  std::atomic<std::uint64_t> published_ = 0;
  std::atomic<bool> connecting_ = false;
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::ros1
