// Races of messages over ROS 1 (roscpp), with a rosmaster that is started here. hands=pointer:
// publish() is given a shared pointer, which subscribers of the same process get; hands=reference:
// it is given a message, and a thread of roscpp's sends it.
#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/message_traits.h>
#include <ros/publisher.h>
#include <ros/serialization.h>
#include <ros/subscriber.h>

#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "delivery_race.hpp"
#include "maide/wire/client/child_process.hpp"
#include "node.hpp"

namespace maide::deliveries {
namespace {

// The round that a message belongs to, and what makes it large.
struct Message {
  std::uint32_t number = 0;
  std::vector<std::uint8_t> data;
};

}  // namespace
}  // namespace maide::deliveries

// What genmsg would write of "uint32 number, uint8[] data", but for the sum: both ends are ours.
namespace ros {
namespace message_traits {

template <>
struct MD5Sum<maide::deliveries::Message> {
  static const char* value() { return "0123456789abcdef0123456789abcdef"; }
  static const char* value(const maide::deliveries::Message&) { return value(); }
};
template <>
struct DataType<maide::deliveries::Message> {
  static const char* value() { return "maide/Delivered"; }
  static const char* value(const maide::deliveries::Message&) { return value(); }
};
template <>
struct Definition<maide::deliveries::Message> {
  static const char* value() { return "uint32 number\nuint8[] data\n"; }
  static const char* value(const maide::deliveries::Message&) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<maide::deliveries::Message> {
  using Message = maide::deliveries::Message;
  template <typename Stream>
  static void write(Stream& stream, const Message& message) {
    stream.next(message.number);
    stream.next(static_cast<std::uint32_t>(message.data.size()));
    if (message.data.empty()) return;
    std::memcpy(stream.advance(length(message)), message.data.data(), message.data.size());
  }
  template <typename Stream>
  static void read(Stream& stream, Message& message) {
    std::uint32_t size = 0;
    stream.next(message.number);
    stream.next(size);
    const std::uint8_t* const data = stream.advance(size);
    message.data.assign(data, data + size);
  }
  static std::uint32_t serializedLength(const Message& message) {
    return 2 * sizeof(std::uint32_t) + length(message);
  }

 private:
  static std::uint32_t length(const Message& message) {
    return static_cast<std::uint32_t>(message.data.size());
  }
};

}  // namespace serialization
}  // namespace ros

namespace maide::deliveries {
namespace {

const char* name(Topic topic) { return topic == Topic::map ? "map" : "notice"; }

class Ros1Writer : public Writer {
 public:
  Ros1Writer(ros::NodeHandle& node, const Settings& settings)
      : hands_pointers_(settings.is("hands", "pointer", "pointer")) {
    for (const Topic topic : both_topics) {
      publishers_.push_back(node.advertise<Message>(name(topic), 10));
    }
  }
  void write(Topic topic, std::uint32_t number, std::size_t size) override {
    const ros::Publisher& publisher = publishers_[static_cast<std::size_t>(topic)];
    const auto message = boost::make_shared<Message>();
    message->number = number;
    message->data.resize(size);
    if (hands_pointers_) {
      publisher.publish(message);
    } else {
      publisher.publish(*message);
    }
  }

 private:
  const bool hands_pointers_;
  std::vector<ros::Publisher> publishers_;
};

class Ros1Reader : public Reader {
 public:
  explicit Ros1Reader(ros::NodeHandle& node) {
    for (const Topic topic : both_topics) {
      End& end = ends_[static_cast<std::size_t>(topic)];
      auto options = ros::SubscribeOptions::create<Message>(
          name(topic), 10,
          [&end](const boost::shared_ptr<const Message>& message) { end.newest = message->number; },
          ros::VoidConstPtr(), &end.callbacks);
      end.subscriber = node.subscribe(options);
    }
  }
  std::optional<std::uint32_t> take(Topic topic) override {
    End& end = ends_[static_cast<std::size_t>(topic)];
    end.newest.reset();
    end.callbacks.callAvailable();
    return end.newest;
  }
  Found look(std::chrono::milliseconds) override {
    throw std::runtime_error("a callback queue is one list: what comes first is called first");
  }

 private:
  struct End {
    ros::CallbackQueue callbacks;
    ros::Subscriber subscriber;
    std::optional<std::uint32_t> newest;
  };
  std::array<End, both_topics.size()> ends_;
};

class Ros1 : public Middleware {
 public:
  explicit Ros1(const Settings& settings)
      : settings_(settings), node_(ros1::Node::start(settings.text("master", ""))) {}
  std::unique_ptr<Writer> make_writer() override {
    return std::make_unique<Ros1Writer>(node_.handle(), settings_);
  }
  std::unique_ptr<Reader> make_reader() override {
    return std::make_unique<Ros1Reader>(node_.handle());
  }

 private:
  const Settings settings_;
  ros1::Node& node_;
};

}  // namespace
}  // namespace maide::deliveries

int main(int count, char** words) {
  using namespace maide;
  std::unique_ptr<ServiceProcess> master;
  const auto prepare = [&](deliveries::Settings& settings) {
    const std::uint16_t port = free_loopback_port();
    master = std::make_unique<ServiceProcess>(
        std::vector<std::string>{"rosmaster", "--core", "-p", std::to_string(port)},
        std::map<std::string, std::string>{{"ROS_IP", "127.0.0.1"},
                                           {"ROS_LOG_DIR", "/"},
                                           {"ROS_PYTHON_LOG_CONFIG_FILE", "/dev/null"}});
    master->wait_for_tcp(port, std::chrono::seconds(50));
    settings.add("master", fmt::format("http://127.0.0.1:{}/", port));
  };
  return deliveries::run(count, words, {prepare, [](const deliveries::Settings& settings) {
                                          return std::make_unique<deliveries::Ros1>(settings);
                                        }});
}
