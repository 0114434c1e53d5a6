// Races of messages over MQTT, through a mosquitto that is started here. qos=0, 1 or 2; the writer
// waits for the broker's acknowledgement where there is one, and a thread of libmosquitto sends.
// connections=1: both topics take the same connection to the broker and from it; 2: each topic has
// its own. library=slow slows the broker down, too.
#include <mosquitto.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "broker.hpp"
#include "delivery_race.hpp"
#include "maide/base/numbers.hpp"
#include "mqtt_client.hpp"

namespace maide::deliveries {
namespace {

std::string name(Topic topic) { return topic == Topic::map ? "map" : "notice"; }

void check(int code, const char* call) {
  if (code != MOSQ_ERR_SUCCESS) {
    throw std::runtime_error(std::string(call) + ": " + mosquitto_strerror(code));
  }
}

// A connection that a thread of libmosquitto serves.
class ServedClient {
 public:
  ServedClient(const Settings& settings, const std::string& id)
      : qos_(static_cast<int>(settings.number("qos", 0))),
        handle_(mosquitto_new(id.c_str(), true, this)) {
    if (handle_ == nullptr) throw std::runtime_error("mosquitto_new fails");
    mosquitto_int_option(handle_, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_publish_callback_set(handle_, [](mosquitto*, void* self, int) {
      ++static_cast<ServedClient*>(self)->acknowledged_;
    });
    check(
        mosquitto_connect(handle_, "127.0.0.1", static_cast<int>(settings.number("port", 0)), 3600),
        "mosquitto_connect");
    check(mosquitto_loop_start(handle_), "mosquitto_loop_start");
  }
  ~ServedClient() {
    mosquitto_disconnect(handle_);
    mosquitto_loop_stop(handle_, false);
    mosquitto_destroy(handle_);
  }
  ServedClient(const ServedClient&) = delete;
  ServedClient& operator=(const ServedClient&) = delete;

  // With QoS 1 and 2 until it is acknowledged.
  void publish(const std::string& topic, const std::string& payload) {
    ++published_;
    check(mosquitto_publish(handle_, nullptr, topic.c_str(), static_cast<int>(payload.size()),
                            payload.data(), qos_, false),
          "mosquitto_publish");
    while (qos_ > 0 && acknowledged_ < published_) std::this_thread::yield();
  }

 private:
  const int qos_;
  mosquitto* handle_;
  std::uint32_t published_ = 0;
  std::atomic<std::uint32_t> acknowledged_ = 0;
};

// The connections of the reader, which are served within its calls.
class Clients {
 public:
  explicit Clients(const Settings& settings) {
    if (::pipe(never_.data()) != 0) throw std::runtime_error("no pipe");
    for (std::uint32_t i = 0; i < settings.number("connections", 1); ++i) {
      mqtt::ClientSettings client;
      client.host = "127.0.0.1";
      client.port = static_cast<std::uint16_t>(settings.number("port", 0));
      client.id = "reader" + std::to_string(i);
      client.qos = static_cast<int>(settings.number("qos", 0));
      clients_.push_back(std::make_unique<mqtt::MqttClient>(client, never_.front()));
      if (!clients_.back()->connect()) throw std::runtime_error("no connection to the broker");
    }
  }
  ~Clients() {
    clients_.clear();
    for (const int end : never_) ::close(end);
  }
  Clients(const Clients&) = delete;
  Clients& operator=(const Clients&) = delete;

  mqtt::MqttClient& of(Topic topic) {
    return topic == Topic::map ? *clients_.front() : *clients_.back();
  }

 private:
  std::array<int, 2> never_{};
  std::vector<std::unique_ptr<mqtt::MqttClient>> clients_;
};

class MqttWriter : public Writer {
 public:
  explicit MqttWriter(const Settings& settings) {
    mosquitto_lib_init();
    for (std::uint32_t i = 0; i < settings.number("connections", 1); ++i) {
      clients_.push_back(std::make_unique<ServedClient>(settings, "writer" + std::to_string(i)));
    }
  }
  // "map 12 ...."
  void write(Topic topic, std::uint32_t number, std::size_t size) override {
    std::string payload = name(topic) + ' ' + std::to_string(number) + ' ';
    if (payload.size() < size) payload.resize(size, '.');
    (topic == Topic::map ? clients_.front() : clients_.back())->publish(name(topic), payload);
  }

 private:
  std::vector<std::unique_ptr<ServedClient>> clients_;
};

class MqttReader : public Reader {
 public:
  explicit MqttReader(const Settings& settings) : clients_(settings) {
    for (const Topic topic : both_topics) {
      if (!clients_.of(topic).subscribe(name(topic))) throw std::runtime_error("no subscription");
    }
  }
  std::optional<std::uint32_t> take(Topic topic) override {
    while (const std::optional<std::string> payload = clients_.of(topic).receive(false)) {
      const std::size_t first = payload->find(' '), second = payload->find(' ', first + 1);
      newest_[payload->substr(0, first)] =
          parse_number<std::uint32_t>(payload->substr(first + 1, second - first - 1));
    }
    std::optional<std::uint32_t> taken;
    std::swap(taken, newest_[name(topic)]);
    return taken;
  }
  Found look(std::chrono::milliseconds) override {
    throw std::runtime_error("a client hands out one message after the other, and no list");
  }

 private:
  Clients clients_;
  std::map<std::string, std::optional<std::uint32_t>> newest_;  // by topic, not taken
};

class Mqtt : public Middleware {
 public:
  explicit Mqtt(const Settings& settings) : settings_(settings) {}
  std::unique_ptr<Writer> make_writer() override { return std::make_unique<MqttWriter>(settings_); }
  std::unique_ptr<Reader> make_reader() override { return std::make_unique<MqttReader>(settings_); }

 private:
  const Settings settings_;
};

}  // namespace
}  // namespace maide::deliveries

int main(int count, char** words) {
  using namespace maide;
  std::unique_ptr<mqtt::Broker> broker;
  const auto prepare = [&](deliveries::Settings& settings) {
    const std::map<std::string, std::string> none;
    broker = std::make_unique<mqtt::Broker>(OptionValues(mqtt::Broker::options(), none));
    settings.add("port", std::to_string(broker->port()));
    if (settings.is("library", "slow", "normal")) deliveries::slow_down(broker->process()->id());
  };
  return deliveries::run(count, words, {prepare, [](const deliveries::Settings& settings) {
                                          return std::make_unique<deliveries::Mqtt>(settings);
                                        }});
}
