#include "domains.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <string>

namespace maide::cyclonedds {
namespace {

// Participants of one domain of this process are joined by a shortcut; so there are two, with the
// same number on the network. That number, of 1 to 200, makes ports of other wrappers unlikely; the
// tag makes what comes in from them nobody's.
std::string network() {
  return fmt::format(
      "<General><AllowMulticast>false</AllowMulticast>"
      "<Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces></General>"
      "<Discovery><ExternalDomainId>{}</ExternalDomainId><Tag>maide-{}</Tag>"
      "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>31"
      "</MaxAutoParticipantIndex><Peers><Peer Address='127.0.0.1'/></Peers></Discovery>",
      1 + ::getpid() % 200, ::getpid());
}

constexpr const char* no_network = "<General><Transport>none</Transport></General>";

}  // namespace

Domains::Domains(Transport transport) {
  const std::string config = transport == Transport::udp ? network() : no_network;
  writing_domain_ = {dds_create_domain(0, config.c_str()), "dds_create_domain"};
  writing_ = {dds_create_participant(0, nullptr, nullptr), "dds_create_participant"};
  if (transport == Transport::none) return;
  reading_domain_ = {dds_create_domain(1, config.c_str()), "dds_create_domain"};
  reading_ = {dds_create_participant(1, nullptr, nullptr), "dds_create_participant"};
}

}  // namespace maide::cyclonedds
