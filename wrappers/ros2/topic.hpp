// kind=topic: publishers and subscriptions of one topic.
//
//   write        publishes one message: `written`
//   read         spins until a message came: `message`
//   tryread      spins without waiting: `message`, as many as take=once|some|all gives, or `null`
//   unsubscribe  drops the subscription; until there is one again, reads say `unsubscribed`
//   subscribe    makes the subscription anew: a late joiner, if something was written before
//
// Messages come by the callback of an executor, as in a program. take=direct calls
// Subscription::take() instead and never spins.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "nodes.hpp"
#include "spinner.hpp"

namespace maide::ros2 {

struct TopicSettings {
  rclcpp::QoS publisher{rclcpp::KeepLast(10)}, subscription{rclcpp::KeepLast(10)};
  std::optional<Spin> spin = Spin::once;  // none: take() without an executor
  bool intraprocess = false;
  std::size_t writers = 1, readers = 1;

  // The rows of the wrapper's table that these come from, QoS and numbers of ends aside.
  static std::vector<OptionSpec> options();
  // Throws UsageError for combinations that make no sense.
  static TopicSettings from(const OptionValues& options);
  // Publisher and subscription agree on their QoS; others never match.
  bool match() const;
  // A late subscription gets what the publisher keeps.
  bool keeps_for_late_readers() const;
};

SystemSetup topic_setup(const TopicSettings& settings, const OptionValues& options);

class Topic : public SystemInstance {
 public:
  // Returns when all ends that can match have matched. Throws std::runtime_error.
  Topic(Nodes& nodes, const TopicSettings& settings, EventSink& sink);
  ~Topic() override;
  void call(std::string_view input) override;
  void shutdown() override;

 private:
  using Message = std_msgs::msg::UInt64;
  struct Reader {
    explicit Reader(const rclcpp::Node::SharedPtr& node) : spinner(node) {}
    Spinner spinner;
    rclcpp::Subscription<Message>::SharedPtr subscription;  // none: unsubscribed
    bool has_read = false;                                  // since the call began
  };
  // All that takes long to delete.
  struct Ends {
    std::vector<rclcpp::Publisher<Message>::SharedPtr> publishers;
    std::vector<std::unique_ptr<Reader>> readers;
  };
  void write();
  void read(Reader& reader, bool waits);
  void take_directly(Reader& reader, bool waits);
  bool take_one(Reader& reader);
  void subscribe(Reader& reader);
  void unsubscribe(Reader& reader);
  bool know_each_other() const;
  void wait_for_matches() const;

  Nodes& nodes_;
  const TopicSettings settings_;
  EventSink& sink_;
  const rclcpp::Node::SharedPtr publishing_, subscribing_;
  const std::string name_;
  const rclcpp::GuardCondition::SharedPtr stop_;  // ends a wait without an executor
  const std::shared_ptr<Ends> ends_ = std::make_shared<Ends>();
  std::atomic<std::uint64_t> written_ = 0;
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::ros2
