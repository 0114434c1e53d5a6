#include "mqtt_client.hpp"

#include <fmt/format.h>
#include <mosquitto.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "maide/base/file.hpp"

namespace maide::mqtt {
namespace {

// A PINGREQ would come in between; words are over long before.
constexpr int keep_alive_seconds = 3600;

void check(int code, const char* call) {
  if (code == MOSQ_ERR_SUCCESS) return;
  throw std::runtime_error(fmt::format("{}: {}", call, mosquitto_strerror(code)));
}

// Once in a process; never cleaned up, as clients may be left behind in calls.
void initialise_library() {
  static const int code = mosquitto_lib_init();
  check(code, "mosquitto_lib_init");
}

}  // namespace

MqttClient::MqttClient(ClientSettings settings, int stop)
    : settings_(std::move(settings)), stop_(stop) {
  initialise_library();
  handle_ = mosquitto_new(settings_.id.c_str(), settings_.clean_session, this);
  if (handle_ == nullptr) throw std::runtime_error("mosquitto_new failed");
  mosquitto_int_option(handle_, MOSQ_OPT_TCP_NODELAY, 1);
  mosquitto_connect_with_flags_callback_set(handle_,
                                            [](mosquitto*, void* self, int code, int flags) {
                                              auto& client = *static_cast<MqttClient*>(self);
                                              client.connack_ = true;
                                              client.connack_code_ = code;
                                              client.session_present_ = (flags & 1) != 0;
                                            });
  mosquitto_subscribe_callback_set(handle_, [](mosquitto*, void* self, int, int, const int*) {
    static_cast<MqttClient*>(self)->suback_ = true;
  });
  mosquitto_publish_callback_set(handle_, [](mosquitto*, void* self, int id) {
    auto& client = *static_cast<MqttClient*>(self);
    client.published_ = client.published_ || id == client.published_id_;
  });
  mosquitto_message_callback_set(handle_, [](mosquitto*, void* self,
                                             const mosquitto_message* message) {
    static_cast<MqttClient*>(self)->received_.emplace_back(
        static_cast<const char*>(message->payload), static_cast<std::size_t>(message->payloadlen));
  });
  if (!settings_.will.empty()) {
    check(mosquitto_will_set(handle_, settings_.will_topic.c_str(),
                             static_cast<int>(settings_.will.size()), settings_.will.data(),
                             settings_.qos, false),
          "mosquitto_will_set");
  }
}

MqttClient::~MqttClient() {
  disconnect();
  mosquitto_destroy(handle_);
}

bool MqttClient::connect() {
  connack_ = false;
  const int code =
      mosquitto_connect(handle_, settings_.host.c_str(), settings_.port, keep_alive_seconds);
  if (code == MOSQ_ERR_ERRNO) {
    throw std::runtime_error(
        fmt::format("no connection to the broker: {}", mosquitto_strerror(code)));
  }
  check(code, "mosquitto_connect");
  connected_ = true;
  if (!wait_for(connack_)) return false;
  if (connack_code_ != 0) throw std::runtime_error(mosquitto_connack_string(connack_code_));
  return true;
}

bool MqttClient::subscribe(const std::string& topic) {
  suback_ = false;
  if (!connected_) return false;
  check(mosquitto_subscribe(handle_, nullptr, topic.c_str(), settings_.qos), "mosquitto_subscribe");
  return wait_for(suback_);
}

bool MqttClient::publish(const std::string& topic, const std::string& payload, bool retain) {
  if (!connected_) return false;
  published_ = false;
  // Without an acknowledgement to come, on_publish is called from within the call.
  const int code =
      mosquitto_publish(handle_, &published_id_, topic.c_str(), static_cast<int>(payload.size()),
                        payload.data(), settings_.qos, retain);
  if (code == MOSQ_ERR_CONN_LOST || code == MOSQ_ERR_NO_CONN) {
    connected_ = false;
    return false;
  }
  check(code, "mosquitto_publish");
  return settings_.qos == 0 || wait_for(published_);
}

bool MqttClient::disconnect() {
  if (!connected_) return false;
  mosquitto_disconnect(handle_);
  connected_ = false;
  return true;
}

bool MqttClient::drop() {
  if (!connected_) return false;
  // What takes the place of its socket is at its end, so that libmosquitto reads no more of what
  // had come; the socket is closed as it would be with its process.
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "socketpair");
  }
  const Descriptor dead(ends[0]);
  ::close(ends[1]);
  ::dup2(dead.get(), mosquitto_socket(handle_));
  while (mosquitto_loop_read(handle_, 1) == MOSQ_ERR_SUCCESS) {
  }
  connected_ = false;
  return true;
}

std::optional<std::string> MqttClient::receive(bool wait) {
  while (received_.empty()) {
    if (!connected_) return std::nullopt;
    if (!wait && !has_input()) return std::nullopt;
    if (!serve()) return std::nullopt;
    // A message of QoS 2 is handed over at the end of its handshake, which goes on by itself.
    if (settings_.qos == 2) wait = true;
  }
  std::string payload = std::move(received_.front());
  received_.pop_front();
  return payload;
}

bool MqttClient::has_input() const {
  pollfd entry{mosquitto_socket(handle_), POLLIN, 0};
  return ::poll(&entry, 1, 0) > 0;
}

bool MqttClient::wait_for(const bool& condition) {
  while (!condition) {
    if (!connected_ || !serve()) return false;
  }
  return true;
}

// Waits until something has come and has libmosquitto handle it. False: stopped, or the connection
// has ended.
bool MqttClient::serve() {
  const bool wants_write = mosquitto_want_write(handle_);
  std::array<pollfd, 2> entries{
      pollfd{mosquitto_socket(handle_), static_cast<short>(wants_write ? POLLIN | POLLOUT : POLLIN),
             0},
      pollfd{stop_, POLLIN, 0}};
  if (::poll(entries.data(), entries.size(), -1) < 0) return errno == EINTR;
  if (entries[1].revents != 0) return false;
  int code = MOSQ_ERR_SUCCESS;
  if ((entries[0].revents & POLLOUT) != 0) code = mosquitto_loop_write(handle_, 1);
  if (code == MOSQ_ERR_SUCCESS && (entries[0].revents & ~POLLOUT) != 0) {
    code = mosquitto_loop_read(handle_, 1);
  }
  if (code == MOSQ_ERR_SUCCESS) return true;
  connected_ = false;
  return false;
}

}  // namespace maide::mqtt
