// What one word is played on in the alphabet of a connection: clients that publish to a topic of
// their own and clients that subscribe to it, as control programs use them.
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "broker.hpp"
#include "connection_setup.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "mqtt_client.hpp"

namespace maide::mqtt {

class MqttConnection : public SystemInstance {
 public:
  // `name`: of the topic, and of what no other client of the broker has as an id.
  MqttConnection(const Broker& broker, const std::string& name, const ConnectionOptions& options,
                 EventSink& sink);
  ~MqttConnection() override;

  void call(std::string_view input) override;
  void shutdown() override;

 private:
  ClientSettings settings(const std::string& role) const;
  void write();
  void read(bool wait);
  void connect_reader();
  MqttClient& writer() { return writers_[sink_.end()]; }
  MqttClient& reader() { return readers_[sink_.end()]; }
  void clean_up();

  const ConnectionOptions options_;
  const Broker& broker_;
  const std::string name_;
  EventSink& sink_;
  Descriptor stop_;
  std::deque<MqttClient> writers_, readers_;
  std::atomic<std::uint64_t> written_ = 0;
};

}  // namespace maide::mqtt
