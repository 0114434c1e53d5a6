// A client of libmosquitto without a thread of its own: the network is served within the calls, as
// it is where a program handles messages in a callback, or calls mosquitto_loop itself. So a
// program that is busy with something else receives and acknowledges nothing.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

struct mosquitto;

namespace maide::mqtt {

struct ClientSettings {
  std::string host;
  std::uint16_t port = 0;
  std::string id;
  bool clean_session = true;
  int qos = 0;  // of what it publishes and subscribes to
  // What the broker publishes, on `will_topic`, if the client goes without a word; "": nothing.
  std::string will_topic, will;
};

class MqttClient {
 public:
  // What blocks in any call returns once there is something to read from `stop`. Throws
  // std::runtime_error.
  MqttClient(ClientSettings settings, int stop);
  ~MqttClient();
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  bool is_connected() const { return connected_; }

  // Each is false if there is no connection, or it ended meanwhile, or `stop` said so.
  // CONNECT, until CONNACK; throws std::runtime_error if the broker cannot be reached or refuses.
  bool connect();
  // Whether the broker still had the session of the last connect().
  bool session_present() const { return session_present_; }
  bool subscribe(const std::string& topic);  // until SUBACK
  // With QoS 1 and 2 until it is acknowledged.
  bool publish(const std::string& topic, const std::string& payload, bool retain);
  bool disconnect();
  bool drop();  // closes the TCP connection without a word

  // The next message's payload, if there is one or, with `wait`, once there is one.
  std::optional<std::string> receive(bool wait);

 private:
  bool serve();
  bool wait_for(const bool& condition);
  bool has_input() const;

  ClientSettings settings_;
  int stop_;
  mosquitto* handle_;
  bool connected_ = false, session_present_ = false;
  // What callbacks said since the call that waits for it.
  bool connack_ = false, suback_ = false, published_ = false;
  int connack_code_ = 0, published_id_ = 0;
  std::deque<std::string> received_;
};

}  // namespace maide::mqtt
