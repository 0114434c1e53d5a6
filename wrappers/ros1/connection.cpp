#include "connection.hpp"

#include <ros/poll_manager.h>

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

Connection::Connection(Node& node, const Queues& queues, EventSink& sink, IdleQueues& idle)
    : node_(node),
      queues_(queues),
      sink_(sink),
      idle_(idle),
      topic_(node.fresh_topic()),
      callbacks_(take_queue(idle)),
      publisher_(
          node.handle().advertise<std_msgs::UInt64>(topic_, queues.publisher, queues.latch)) {
  if (!publisher_) throw std::runtime_error("the rosmaster does not take the publisher");
  connect();
}

Connection::~Connection() {
  subscriber_.reset();  // first: a subscriber that loses its publisher tries to connect again
  publisher_.shutdown();
  idle_.push_back(std::move(callbacks_));
}

void Connection::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write") {
    publish(1);
  } else if (input == "burst") {
    publish(queues_.burst);
  } else if (input == "read") {
    read();
  } else if (input == "tryread") {
    try_read();
  } else if (input == "disconnect") {
    disconnect();
  } else if (input == "connect") {
    connect();
    sink_.report("connected");
  } else if (input == "interrupt") {
    callbacks_->disable();
    sink_.report("done");
  } else if (input == "resume") {
    callbacks_->enable();
    sink_.report("resumed");
  } else if (input == "clear") {
    callbacks_->clear();
    sink_.report("cleared");
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

// Subscribes, if there is no subscriber, and waits until both ends know of each other.
void Connection::connect() {
  if (subscriber_) return;
  connecting_ = true;
  auto options = ros::SubscribeOptions::create<std_msgs::UInt64>(
      topic_, queues_.subscriber,
      [this](const std_msgs::UInt64ConstPtr& message) { receive(message); }, ros::VoidConstPtr(),
      callbacks_.get());
  subscriber_ = subscribe(node_.handle(), options, queues_.transport);
  const auto deadline = std::chrono::steady_clock::now() + 5s;
  while (publisher_.getNumSubscribers() != 1 || subscriber_->count_publishers() != 1) {
    if (std::chrono::steady_clock::now() > deadline) {
      throw std::runtime_error("publisher and subscriber do not find each other within 5 s");
    }
    std::this_thread::sleep_for(50us);
  }
  connecting_ = false;
}

void Connection::disconnect() {
  subscriber_.reset();
  sink_.report("disconnected");
}

void Connection::publish(std::size_t messages) {
  for (std::size_t i = 0; i < messages; ++i) {
    const auto message = boost::make_shared<std_msgs::UInt64>();
    message->data = ++published_;
    // Given away, a message is handed on as it is within a process; otherwise it is written down.
    if (queues_.transport == Transport::intraprocess) {
      publisher_.publish(message);
      // A latched message also goes to the poll thread, which roscpp forgets to wake for it: it
      // looks within 100 ms, and meanwhile whoever subscribes gets the message twice.
      if (queues_.latch) ros::PollManager::instance()->getPollSet().signal();
    } else {
      publisher_.publish(*message);
    }
  }
  sink_.report("written");
}

// One callback that brings a message, however long it takes.
void Connection::read() {
  received_ = false;
  while (!received_ && !stopped_) {
    const auto result = callbacks_->callOne(ros::WallDuration(1));
    if (result == ros::CallbackQueue::Disabled) {
      sink_.report("failed");
      return;
    }
  }
}

void Connection::try_read() {
  received_ = false;
  while (!received_ && !stopped_) {
    const auto result = callbacks_->callOne();
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

// Called from within callOne.
void Connection::receive(const std_msgs::UInt64ConstPtr& message) {
  received_ = true;
  sink_.message(message->data);
}

// The master's main thread sleeps and looks at nothing but whether it shall end. roscpp itself
// waits for events only, but for connect(), which looks whether it is done.
bool Connection::polls_in_vain() const { return !connecting_; }

void Connection::shutdown() {
  stopped_ = true;
  callbacks_->disable();
}

}  // namespace maide::ros1
