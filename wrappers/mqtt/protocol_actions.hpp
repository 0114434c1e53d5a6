// The alphabet of the protocol, as published work learns it (Tappler, Aichernig, Bloem,
// "Model-based testing IoT communication via active automata learning", ICST 2017): an input is a
// packet that a raw client sends, an output a packet that comes back. There are one or two clients
// (names of the second begin with c2_) and two topics (names that end with _b speak of the second).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace maide::mqtt {

struct ProtocolAction {
  enum class Kind : std::uint8_t {
    connect,
    connect_will,         // with a will on the first topic
    connect_will_retain,  // with a will that is retained
    disconnect,
    drop,  // the TCP connection is closed without a packet
    ping,
    invalid,  // a packet of the reserved type 0
    publish_qos0,
    publish_qos1,
    publish_qos2,  // PUBLISH alone; the client sends PUBREL when told to
    pubrel,
    publish_retained,  // QoS 1
    delete_retained,   // QoS 1: an empty payload with the retain flag
    subscribe,
    unsubscribe,
  };
  std::string name;
  Kind kind = Kind::connect;
  std::size_t client = 0;  // 0 or 1
  std::size_t topic = 0;   // 0 or 1
};

// All inputs of that many clients.
const std::vector<ProtocolAction>& protocol_actions();

// All outputs of a client, by their names without the client's prefix.
const std::vector<std::string>& protocol_events();

// "" or "c2_".
std::string client_prefix(std::size_t client);

}  // namespace maide::mqtt
