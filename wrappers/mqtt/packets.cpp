#include "packets.hpp"

#include <stdexcept>

namespace maide::mqtt {
namespace {

std::string number(std::uint16_t value) {
  return {static_cast<char>(value >> 8), static_cast<char>(value & 0xff)};
}

std::string text(std::string_view value) {
  return number(static_cast<std::uint16_t>(value.size())) + std::string(value);
}

std::string packet(PacketType type, unsigned flags, const std::string& body) {
  std::string bytes(1, static_cast<char>((static_cast<unsigned>(type) << 4) | flags));
  std::size_t length = body.size();
  do {
    const std::size_t digit = length % 128;
    length /= 128;
    bytes += static_cast<char>(digit | (length > 0 ? 128 : 0));
  } while (length > 0);
  return bytes + body;
}

std::uint16_t read_number(const std::string& bytes, std::size_t place) {
  if (place + 2 > bytes.size()) throw std::runtime_error("the broker sent too short a packet");
  return static_cast<std::uint16_t>((static_cast<unsigned char>(bytes[place]) << 8) |
                                    static_cast<unsigned char>(bytes[place + 1]));
}

}  // namespace

std::string encode_connect(std::string_view client, bool clean_session,
                           const std::optional<Publication>& will) {
  unsigned flags = clean_session ? 0x02 : 0;
  if (will) {
    flags |= 0x04 | (static_cast<unsigned>(will->qos) << 3) | (will->retain ? 0x20U : 0U);
  }
  std::string body = text("MQTT") + '\x04' + static_cast<char>(flags) + number(0) + text(client);
  if (will) body += text(will->topic) + text(will->payload);
  return packet(PacketType::connect, 0, body);
}

std::string encode_publish(const Publication& publication) {
  const unsigned flags =
      (static_cast<unsigned>(publication.qos) << 1) | (publication.retain ? 1U : 0U);
  std::string body = text(publication.topic);
  if (publication.qos > 0) body += number(publication.id);
  return packet(PacketType::publish, flags, body + publication.payload);
}

std::string encode_subscribe(std::string_view topic, int qos, std::uint16_t id) {
  return packet(PacketType::subscribe, 2, number(id) + text(topic) + static_cast<char>(qos));
}

std::string encode_unsubscribe(std::string_view topic, std::uint16_t id) {
  return packet(PacketType::unsubscribe, 2, number(id) + text(topic));
}

std::string encode_acknowledgement(PacketType type, std::uint16_t id) {
  return packet(type, type == PacketType::pubrel ? 2 : 0, number(id));
}

std::string encode_empty(PacketType type) { return packet(type, 0, ""); }

std::optional<Packet> take_packet(std::string& bytes) {
  std::size_t length = 0;
  std::size_t place = 1;
  for (unsigned shift = 0;; shift += 7, ++place) {
    if (place >= bytes.size()) return std::nullopt;
    if (shift > 21) throw std::runtime_error("the broker sent what is no packet of MQTT");
    const auto digit = static_cast<unsigned char>(bytes[place]);
    length |= static_cast<std::size_t>(digit & 127U) << shift;
    if (digit < 128) break;
  }
  ++place;
  if (bytes.size() < place + length) return std::nullopt;
  const auto head = static_cast<unsigned char>(bytes[0]);
  Packet packet{static_cast<PacketType>(head >> 4), static_cast<std::uint8_t>(head & 15U),
                bytes.substr(place, length)};
  bytes.erase(0, place + length);
  return packet;
}

Publication parse_publication(const Packet& packet) {
  Publication publication;
  publication.qos = (packet.flags >> 1) & 3;
  publication.retain = (packet.flags & 1U) != 0;
  std::size_t place = 2 + std::size_t{read_number(packet.body, 0)};
  publication.topic = packet.body.substr(2, place - 2);
  if (place > packet.body.size()) throw std::runtime_error("the broker sent too short a packet");
  if (publication.qos > 0) {
    publication.id = read_number(packet.body, place);
    place += 2;
  }
  publication.payload = packet.body.substr(place);
  return publication;
}

std::uint8_t byte_of(const Packet& packet, std::size_t place) {
  if (place >= packet.body.size()) throw std::runtime_error("the broker sent too short a packet");
  return static_cast<std::uint8_t>(packet.body[place]);
}

std::uint16_t id_of(const Packet& packet) { return read_number(packet.body, 0); }

}  // namespace maide::mqtt
