#include "ros1_connection.hpp"

#include <ros/poll_manager.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace maide::ros1 {
namespace {

using namespace std::chrono_literals;

std::unique_ptr<ros::CallbackQueue> take_queue(IdleQueues& idle) {
  if (idle.empty()) return std::make_unique<ros::CallbackQueue>();
  std::unique_ptr<ros::CallbackQueue> queue = std::move(idle.back());
  idle.pop_back();
  queue->clear();
  queue->enable();
  return queue;
}

}  // namespace

Ros1Connection::Ros1Connection(Node& node, const Queues& queues, EventSink& sink, IdleQueues& idle)
    : node_(node),
      queues_(queues),
      sink_(sink),
      idle_(idle),
      topic_(node.fresh_topic()),
      subscribers_(queues.readers) {
  for (std::size_t i = 0; i < queues.writers; ++i) {
    publishers_.push_back(
        node.handle().advertise<std_msgs::UInt64>(topic_, queues.publisher, queues.latch));
    if (!publishers_.back()) throw std::runtime_error("the rosmaster does not take the publisher");
  }
  for (Subscriber& subscriber : subscribers_) {
    subscriber.callbacks = take_queue(idle);
    connect(subscriber);
  }
}

Ros1Connection::~Ros1Connection() {
  // First: a subscriber that loses its publisher tries to connect again.
  for (Subscriber& subscriber : subscribers_) subscriber.end.reset();
  for (ros::Publisher& publisher : publishers_) publisher.shutdown();
  for (Subscriber& subscriber : subscribers_) {
    if (subscriber.callbacks) idle_.push_back(std::move(subscriber.callbacks));
  }
}

void Ros1Connection::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write" || input == "burst") {
    publish(input == "write" ? 1 : queues_.burst);
    return;
  }
  Subscriber& subscriber = subscribers_[sink_.end()];
  if (input == "read") {
    read(subscriber);
  } else if (input == "tryread") {
    try_read(subscriber);
  } else if (input == "disconnect") {
    subscriber.end.reset();
    sink_.report("disconnected");
  } else if (input == "connect") {
    connect(subscriber);
    sink_.report("connected");
  } else if (input == "interrupt") {
    subscriber.callbacks->disable();
    sink_.report("done");
  } else if (input == "resume") {
    subscriber.callbacks->enable();
    sink_.report("resumed");
  } else if (input == "clear") {
    subscriber.callbacks->clear();
    sink_.report("cleared");
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

// Subscribes, if it is no subscriber, and waits until all ends know of each other. The publishers
// of one node are one to its peers; so are, within a process, its subscribers.
void Ros1Connection::connect(Subscriber& subscriber) {
  if (subscriber.end) return;
  connecting_ = true;
  auto options = ros::SubscribeOptions::create<std_msgs::UInt64>(
      topic_, queues_.subscriber,
      [this, &subscriber](const std_msgs::UInt64ConstPtr& message) {
        subscriber.received = true;
        sink_.message(message->data);
      },
      ros::VoidConstPtr(), subscriber.callbacks.get());
  subscriber.end = subscribe(node_.handle(), options, queues_.transport);
  const auto connected = static_cast<std::uint32_t>(
      std::count_if(subscribers_.begin(), subscribers_.end(),
                    [](const Subscriber& other) { return other.end != nullptr; }));
  const std::uint32_t links = queues_.transport == Transport::tcpros ? connected : 1;
  const auto deadline = std::chrono::steady_clock::now() + 5s;
  while (publishers_.front().getNumSubscribers() != links ||
         subscriber.end->count_publishers() != 1) {
    if (std::chrono::steady_clock::now() > deadline) {
      throw std::runtime_error("publishers and subscribers do not find each other within 5 s");
    }
    std::this_thread::sleep_for(50us);
  }
  connecting_ = false;
}

void Ros1Connection::publish(std::size_t messages) {
  const ros::Publisher& publisher = publishers_[sink_.end()];
  for (std::size_t i = 0; i < messages; ++i) {
    const auto message = boost::make_shared<std_msgs::UInt64>();
    message->data = sink_.content(++published_);
    // Given away, a message is handed on as it is within a process; otherwise it is written down.
    if (queues_.transport == Transport::intraprocess) {
      publisher.publish(message);
      // A latched message also goes to the poll thread, which roscpp forgets to wake for it: it
      // looks within 100 ms, and meanwhile whoever subscribes gets the message twice.
      if (queues_.latch) ros::PollManager::instance()->getPollSet().signal();
    } else {
      publisher.publish(*message);
    }
  }
  sink_.report("written");
}

// One callback that brings a message, however long it takes.
void Ros1Connection::read(Subscriber& subscriber) {
  subscriber.received = false;
  while (!subscriber.received && !stopped_) {
    const auto result = subscriber.callbacks->callOne(ros::WallDuration(1));
    if (result == ros::CallbackQueue::Disabled) {
      sink_.report("failed");
      return;
    }
  }
}

void Ros1Connection::try_read(Subscriber& subscriber) {
  subscriber.received = false;
  while (!subscriber.received && !stopped_) {
    const auto result = subscriber.callbacks->callOne();
    if (result == ros::CallbackQueue::Disabled) {
      sink_.report("failed");
      return;
    }
    if (result == ros::CallbackQueue::Empty) {
      sink_.report("null");
      return;
    }
  }
}

// The master's main thread sleeps and looks at nothing but whether it shall end. roscpp itself
// waits for events only, but for connect(), which looks whether it is done.
bool Ros1Connection::polls_in_vain() const { return !connecting_; }

void Ros1Connection::shutdown() {
  stopped_ = true;
  for (Subscriber& subscriber : subscribers_) subscriber.callbacks->disable();
}

}  // namespace maide::ros1
