// The wrapper for MQTT: `maide learn mqtt qos=1 session=persistent`. A real broker, mosquitto, runs
// beside it. In the alphabet of a connection a client of libmosquitto publishes and another
// subscribes; in that of the protocol raw clients send single packets and what comes back is seen.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "broker.hpp"
#include "connection_setup.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "raw_clients.hpp"

namespace maide::mqtt {

class MqttWrapper : public SystemWrapper {
 public:
  MqttWrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  WrapperDescription description_;
  ConnectionOptions connection_;
  RawClientOptions raw_clients_;
  bool is_protocol_ = false;
  std::optional<Broker> broker_;
  std::string name_;  // of this wrapper among the broker's clients
  std::uint64_t words_ = 0;
};

}  // namespace maide::mqtt
