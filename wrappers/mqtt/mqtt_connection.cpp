#include "mqtt_connection.hpp"

#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "maide/base/error.hpp"

namespace maide::mqtt {
namespace {

constexpr std::string_view will_payload = "will";

Descriptor make_stop_event() {
  Descriptor event(::eventfd(0, EFD_CLOEXEC));
  if (!event.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
  return event;
}

void stop(const Descriptor& event) { ::eventfd_write(event.get(), 1); }

}  // namespace

MqttConnection::MqttConnection(const Broker& broker, const std::string& name,
                               const ConnectionOptions& options, EventSink& sink)
    : options_(options), broker_(broker), name_(name), sink_(sink), stop_(make_stop_event()) {
  bool are_connected = true;
  for (std::size_t i = 0; i < options_.writers; ++i) {
    ClientSettings writer = settings("writer" + std::to_string(i));
    writer.clean_session = true;
    if (options_.will) {
      writer.will_topic = name_;
      writer.will = will_payload;
    }
    are_connected &= writers_.emplace_back(std::move(writer), stop_.get()).connect();
  }
  for (std::size_t i = 0; i < options_.readers; ++i) {
    MqttClient& reader = readers_.emplace_back(settings("reader" + std::to_string(i)), stop_.get());
    are_connected = are_connected && reader.connect() && reader.subscribe(name_);
  }
  if (!are_connected) throw std::runtime_error("the broker ended a connection at once");
}

MqttConnection::~MqttConnection() {
  try {
    clean_up();
  } catch (const std::exception&) {
    // The broker has gone: nothing to be cleaned.
  }
}

// What a session or a retained message would leave behind in the broker for ever.
void MqttConnection::clean_up() {
  writers_.clear();
  readers_.clear();
  const Descriptor never = make_stop_event();
  for (std::size_t i = 0; i < options_.readers && !options_.clean_session; ++i) {
    ClientSettings forget = settings("reader" + std::to_string(i));
    forget.clean_session = true;
    MqttClient(std::move(forget), never.get()).connect();
  }
  if (options_.retain) {
    ClientSettings erase = settings("eraser");
    erase.clean_session = true;
    MqttClient eraser(std::move(erase), never.get());
    if (eraser.connect()) eraser.publish(name_, "", true);
  }
}

ClientSettings MqttConnection::settings(const std::string& role) const {
  ClientSettings settings;
  settings.host = broker_.host();
  settings.port = broker_.port();
  settings.id = name_ + role;
  settings.clean_session = options_.clean_session;
  settings.qos = options_.qos;
  return settings;
}

void MqttConnection::call(std::string_view input) {
  if (input == "write") {
    write();
  } else if (input == "read") {
    read(true);
  } else if (input == "tryread") {
    read(false);
  } else if (input == "disconnect") {
    sink_.report(reader().disconnect() ? "disconnected" : "offline");
  } else if (input == "drop") {
    sink_.report(reader().drop() ? "disconnected" : "offline");
  } else if (input == "connect") {
    connect_reader();
  } else if (input == "writer_disconnect") {
    sink_.report(writer().disconnect() ? "writer_disconnected" : "failed");
  } else if (input == "writer_drop") {
    sink_.report(writer().drop() ? "writer_disconnected" : "failed");
  } else if (input == "writer_connect") {
    if (writer().is_connected() || writer().connect()) sink_.report("writer_connected");
  } else {
    throw std::logic_error(fmt::format("no input '{}'", input));
  }
}

void MqttConnection::write() {
  if (!writer().publish(name_, std::to_string(sink_.content(written_ + 1)), options_.retain)) {
    sink_.report("failed");
    return;
  }
  ++written_;
  sink_.report("written");
}

void MqttConnection::read(bool wait) {
  const std::optional<std::string> payload = reader().receive(wait);
  if (!payload) {
    sink_.report(wait ? "offline" : "null");
  } else if (*payload == will_payload) {
    sink_.report("will");
  } else {
    sink_.message(std::stoull(*payload));
  }
}

// A session that the broker still has is subscribed already.
void MqttConnection::connect_reader() {
  const bool is_connected =
      reader().is_connected() ||
      (reader().connect() && (reader().session_present() || reader().subscribe(name_)));
  sink_.report(is_connected ? "connected" : "offline");
}

void MqttConnection::shutdown() { stop(stop_); }

}  // namespace maide::mqtt
