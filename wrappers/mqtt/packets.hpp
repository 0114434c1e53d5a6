// The control packets of MQTT 3.1.1 that the raw clients send and receive. By hand, and only what
// is needed: a client library hides just what is to be seen here, and refuses to send what a broker
// must refuse. Source: OASIS, "MQTT Version 3.1.1" (2014), chapters 2 and 3.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace maide::mqtt {

enum class PacketType : std::uint8_t {
  reserved,
  connect,
  connack,
  publish,
  puback,
  pubrec,
  pubrel,
  pubcomp,
  subscribe,
  suback,
  unsubscribe,
  unsuback,
  pingreq,
  pingresp,
  disconnect,
};

struct Publication {
  std::string topic, payload;
  int qos = 0;
  bool retain = false;
  std::uint16_t id = 0;  // 0 with QoS 0
};

// No keep-alive; `will` is what the broker publishes if the client goes without a word.
std::string encode_connect(std::string_view client, bool clean_session,
                           const std::optional<Publication>& will);
std::string encode_publish(const Publication& publication);
std::string encode_subscribe(std::string_view topic, int qos, std::uint16_t id);
std::string encode_unsubscribe(std::string_view topic, std::uint16_t id);
// PUBACK, PUBREC, PUBREL, PUBCOMP.
std::string encode_acknowledgement(PacketType type, std::uint16_t id);
// PINGREQ, DISCONNECT, and RESERVED, which no broker may accept.
std::string encode_empty(PacketType type);

struct Packet {
  PacketType type = PacketType::reserved;
  std::uint8_t flags = 0;
  std::string body;
};

// Takes the first packet out of `bytes`; nothing if it is not whole yet. Throws std::runtime_error
// for what is no packet.
std::optional<Packet> take_packet(std::string& bytes);
// Throws std::runtime_error if `packet` is too short to be one.
Publication parse_publication(const Packet& packet);
// Byte `place` of the body. Throws as above.
std::uint8_t byte_of(const Packet& packet, std::size_t place);
std::uint16_t id_of(const Packet& packet);

}  // namespace maide::mqtt
